/* Euclidean distances by direct differences: no cancellation, the same bits everywhere. */
#include <math.h>

#include "kernel.h"

#define LANES 16

/* Distance of two rows of length d, a multiple of LANES. */
static inline float distance(const float *RESTRICT x, const float *RESTRICT y, int64_t d)
{
    float sums[LANES] = {0};
    for (int64_t k = 0; k < d; k += LANES)
        for (int lane = 0; lane < LANES; ++lane) {
            const float difference = x[k + lane] - y[k + lane];
            sums[lane] += difference * difference;
        }
    float halves[8], quarters[4];
    for (int lane = 0; lane < 8; ++lane) halves[lane] = sums[lane] + sums[lane + 8];
    for (int lane = 0; lane < 4; ++lane) quarters[lane] = halves[lane] + halves[lane + 4];
    return sqrtf((quarters[0] + quarters[2]) + (quarters[1] + quarters[3]));
}

/* out (m, n): distances between the rows of x (m, d) and y (n, d); with upper, x is y and
 * only out[i][j] with i < j is written. */
void VARIANT(distances)(const float *x, int64_t m, const float *y, int64_t n, int64_t d, int upper,
                        float *out)
{
    for (int64_t i = 0; i < m; ++i)
        for (int64_t j = upper ? i + 1 : 0; j < n; ++j)
            out[i * n + j] = distance(x + i * d, y + j * d, d);
}
