/* Extension of a cocycle from the births to all edges, through the fill vertices. */
#include <stdlib.h>

#include "kernel.h"

#define AHEAD 6

/* The value from a to b in a table of the upper triangle. */
static int32_t value_from(const uint16_t *values, int64_t n, int64_t a, int64_t b, int32_t modulus)
{
    const uint16_t stored = values[a < b ? a * n + b : b * n + a];
    const int32_t value = modulus ? (int32_t)stored : (int32_t)(int16_t)stored;
    return a < b ? value : -value;
}

/* values (count): a cocycle on each edge, from its values on the births (keys ascending), mod
 * modulus, or over the integers when modulus is 0. 1 when done, 0 when an integer would leave
 * 15 bits, -1 when memory runs out. */
int VARIANT(propagate)(const uint64_t *keys, int64_t count, const uint16_t *fill, int64_t n,
                       const uint64_t *births, const int32_t *on_births, int64_t born,
                       int32_t modulus, int32_t *values)
{
    int64_t birth = 0;
    int32_t value = 0;
    uint16_t *table = malloc((size_t)(n * n) * sizeof *table);
    if (!table) return -1;
    for (int64_t k = 0; k < count && value <= INT16_MAX && value >= -INT16_MAX; ++k) {
        const int64_t i = key_low(keys[k]), j = key_high(keys[k]), through = fill[i * n + j];
        if (k + AHEAD < count)
            PREFETCH(fill + key_low(keys[k + AHEAD]) * n + key_high(keys[k + AHEAD]));
        value = 0;
        if (through != NO_VERTEX)
            value = value_from(table, n, i, through, modulus) +
                    value_from(table, n, through, j, modulus);
        else if (birth < born && births[birth] == keys[k])
            value = on_births[birth++];
        if (modulus) value = (value % modulus + modulus) % modulus;
        values[k] = value;
        table[i * n + j] = (uint16_t)value;
        if (modulus) value = 0;
    }
    free(table);
    return value <= INT16_MAX && value >= -INT16_MAX;
}
