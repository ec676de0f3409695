/* The exported functions: each calls the build that the processor runs best. */
#include "rips.h"

static const kernel_table *kernel(void)
{
#if defined(ROUNDELAY_WIDE) && defined(__GNUC__)
    if (__builtin_cpu_supports("avx2")) return &kernel_wide;
#elif defined(ROUNDELAY_WIDE) && defined(_MSC_VER)
    int registers[4];
    __cpuid(registers, 1);
    const int system_saves_wide = registers[2] >> 27 & 1 && (_xgetbv(0) & 6) == 6;
    __cpuidex(registers, 7, 0);
    if (system_saves_wide && registers[1] >> 5 & 1) return &kernel_wide;
#endif
    return &kernel_baseline;
}

EXPORT void roundelay_distances(const float *x, int64_t m, const float *y, int64_t n, int64_t d,
                                int upper, float *out)
{
    kernel()->distances(x, m, y, n, d, upper, out);
}

EXPORT rips *roundelay_rips_run(const float *lengths, int64_t n, const uint16_t *label, float limit,
                                uint32_t prime, int64_t wanted, uint64_t *keys, uint16_t *fill)
{
    return kernel()->run(lengths, n, label, limit, prime, wanted, keys, fill);
}

EXPORT void roundelay_rips_free(rips *state) { kernel()->free(state); }

EXPORT int32_t roundelay_interface(void) { return INTERFACE; }

/* sizes: edges processed, merges, births, relations and their entries, reduced columns and
 * their entries, and whether a coefficient left the range of 64 bits. */
EXPORT void roundelay_rips_sizes(const rips *state, int64_t sizes[8])
{
    const int64_t all[8] = {state->processed,         state->merged,
                            state->born,              state->relations.count,
                            state->relations.entries, state->reduced.count,
                            state->reduced.entries,   state->failed == OUT_OF_RANGE};
    memcpy(sizes, all, sizeof all);
}

EXPORT void roundelay_rips_bars(const rips *state, float *merges, uint64_t *births, float *deaths,
                                int64_t *killer)
{
    const size_t born = (size_t)state->born;
    memcpy(merges, state->merges, (size_t)state->merged * sizeof *merges);
    if (!born) return;
    memcpy(births, state->births, born * sizeof *births);
    memcpy(deaths, state->deaths, born * sizeof *deaths);
    memcpy(killer, state->killer, born * sizeof *killer);
}

/* Copy the relations (reduced or as found) as compressed columns. */
EXPORT void roundelay_rips_columns(const rips *state, int reduced, int64_t *start, int32_t *index,
                                   int64_t *value, float *time)
{
    const columns *from = reduced ? &state->reduced : &state->relations;
    memcpy(start, from->start, (size_t)(from->count + 1) * sizeof *start);
    if (!from->count) return;
    memcpy(index, from->index, (size_t)from->entries * sizeof *index);
    memcpy(value, from->value, (size_t)from->entries * sizeof *value);
    memcpy(time, from->time, (size_t)from->count * sizeof *time);
}

EXPORT int roundelay_propagate(const uint64_t *keys, int64_t count, const uint16_t *fill, int64_t n,
                               const uint64_t *births, const int32_t *on_births, int64_t born,
                               int32_t modulus, int32_t *values)
{
    return kernel()->propagate(keys, count, fill, n, births, on_births, born, modulus, values);
}

EXPORT double roundelay_harmonic(const uint64_t *keys, const int32_t *values, int64_t count,
                                 int64_t n, int64_t close, double tolerance, int64_t most,
                                 double *w)
{
    return kernel()->harmonic(keys, values, count, n, close, tolerance, most, w);
}
