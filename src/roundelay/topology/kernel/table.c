/* The entry points of one build. */
#include "rips.h"

#ifdef WIDE
#define TABLE kernel_wide
#else
#define TABLE kernel_baseline
#endif

void VARIANT(distances)(const float *, int64_t, const float *, int64_t, int64_t, int, float *);
rips *VARIANT(rips_run)(const float *, int64_t, const uint16_t *, float, uint32_t, int64_t,
                        uint64_t *, uint16_t *);
void VARIANT(rips_free)(rips *);
int VARIANT(propagate)(const uint64_t *, int64_t, const uint16_t *, int64_t, const uint64_t *,
                       const int32_t *, int64_t, int32_t, int32_t *);
double VARIANT(harmonic)(const uint64_t *, const int32_t *, int64_t, int64_t, int64_t, double,
                         int64_t, double *);

const kernel_table TABLE = {VARIANT(distances), VARIANT(rips_run), VARIANT(rips_free),
                            VARIANT(propagate), VARIANT(harmonic)};
