/* Euclidean distances by direct differences: no cancellation, the same bits everywhere. */
#include <math.h>

#include "kernel.h"

#define LANES 16
#define ROWS 4

static float fold(float *sums)
{
    for (int half = LANES / 2; half > 0; half /= 2)
        for (int lane = 0; lane < half; ++lane) sums[lane] += sums[lane + half];
    return sqrtf(sums[0]);
}

/* Distances from ROWS points x (rows of length d, a multiple of LANES) to the point y. */
static void tile(const float *RESTRICT x, const float *RESTRICT y, int64_t d, float out[ROWS])
{
    float sums[ROWS][LANES] = {{0}};
    for (int64_t k = 0; k < d; k += LANES)
        for (int row = 0; row < ROWS; ++row)
            for (int lane = 0; lane < LANES; ++lane) {
                const float difference = x[row * d + k + lane] - y[k + lane];
                sums[row][lane] += difference * difference;
            }
    for (int row = 0; row < ROWS; ++row) out[row] = fold(sums[row]);
}

static float distance(const float *x, const float *y, int64_t d)
{
    float sums[LANES] = {0};
    for (int64_t k = 0; k < d; k += LANES)
        for (int lane = 0; lane < LANES; ++lane) {
            const float difference = x[k + lane] - y[k + lane];
            sums[lane] += difference * difference;
        }
    return fold(sums);
}

/* out (m, n): distances between the rows of x (m, d) and y (n, d); with upper, x is y and
 * only out[i][j] with i < j is written. */
void VARIANT(distances)(const float *x, int64_t m, const float *y, int64_t n, int64_t d, int upper,
                        float *out)
{
    for (int64_t i = 0; i < m; i += ROWS) {
        const int64_t rows = m - i < ROWS ? m - i : ROWS;
        for (int64_t j = upper ? i + 1 : 0; j < n; ++j) {
            float row_out[ROWS];
            if (rows == ROWS)
                tile(x + i * d, y + j * d, d, row_out);
            else
                for (int64_t row = 0; row < rows; ++row)
                    row_out[row] = distance(x + (i + row) * d, y + j * d, d);
            for (int64_t row = 0; row < rows; ++row)
                if (!upper || j > i + row) out[(i + row) * n + j] = row_out[row];
        }
    }
}
