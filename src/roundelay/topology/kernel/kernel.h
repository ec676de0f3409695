/* Exact degree-1 persistent cohomology of Vietoris-Rips filtrations: shared declarations.
 *
 * Every source is compiled once for the baseline processor and once more with wider
 * vectors (SUFFIX names the build); dispatch.c exports the one that the processor runs.
 * Both give the same bits: no fused multiply-add, sums in a fixed order.
 *
 * Vertices are numbered 0..n-1 (n <= 65535). An edge i < j of length d is the 64-bit key
 * (bits of the float d) << 32 | i << 16 | j, so that keys sort as the filtration does,
 * ties by vertex numbers.
 */
#ifndef ROUNDELAY_KERNEL_H
#define ROUNDELAY_KERNEL_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#ifdef _MSC_VER
#include <intrin.h>
#define EXPORT __declspec(dllexport)
#define PREFETCH(address) _mm_prefetch((const char *)(address), 0)
#define RESTRICT __restrict
#else
#define EXPORT __attribute__((visibility("default")))
#define PREFETCH(address) __builtin_prefetch(address)
#define RESTRICT restrict
#endif

#define PASTE_(name, suffix) name##suffix
#define PASTE(name, suffix) PASTE_(name, suffix)
#ifdef SUFFIX
#define VARIANT(name) PASTE(name, SUFFIX)
#else
#define VARIANT(name) name
#endif

/* The number of the interface: raised with every change of a function or of what it does, so that
 * a binary of another version is noticed. The same number stands in compiled.py. */
#define INTERFACE 2

/* Why a run failed. */
enum { WHOLE = 0, OUT_OF_MEMORY = 1, OUT_OF_RANGE = 2 };

#define NO_VERTEX 0xFFFFu /* fill of an edge whose lune was empty */

typedef struct rips rips;

/* One table of entry points per build. */
typedef struct {
    void (*distances)(const float *, int64_t, const float *, int64_t, int64_t, int, float *);
    rips *(*run)(const float *, int64_t, const uint16_t *, float, uint32_t, int64_t, uint64_t *,
                 uint16_t *);
    void (*free)(rips *);
    int (*propagate)(const uint64_t *, int64_t, const uint16_t *, int64_t, const uint64_t *,
                     const int32_t *, int64_t, int32_t, int32_t *);
    double (*harmonic)(const uint64_t *, const int32_t *, int64_t, int64_t, int64_t, double, int64_t,
                       double *);
} kernel_table;

extern const kernel_table kernel_baseline;
extern const kernel_table kernel_wide;

static inline float key_length(uint64_t key)
{
    const uint32_t bits = (uint32_t)(key >> 32);
    float length;
    memcpy(&length, &bits, sizeof length);
    return length;
}

static inline uint64_t edge_key(float length, uint32_t i, uint32_t j)
{
    uint32_t bits;
    memcpy(&bits, &length, sizeof bits);
    return (uint64_t)bits << 32 | (i < j ? i << 16 | j : j << 16 | i);
}

static inline uint32_t key_low(uint64_t key) { return (uint32_t)(key >> 16) & 0xFFFFu; }
static inline uint32_t key_high(uint64_t key) { return (uint32_t)key & 0xFFFFu; }

/* Position of the lowest set bit of a word that is not 0. */
static inline uint32_t lowest_bit(uint64_t word)
{
#if defined(_MSC_VER) && (defined(_M_X64) || defined(_M_ARM64))
    unsigned long index;
    _BitScanForward64(&index, word);
    return index;
#elif defined(__GNUC__)
    return (uint32_t)__builtin_ctzll(word);
#else
    uint32_t index = 0;
    for (; !(word & 1); word >>= 1) ++index;
    return index;
#endif
}

static inline uint32_t highest_bit(uint64_t word)
{
#if defined(_MSC_VER) && (defined(_M_X64) || defined(_M_ARM64))
    unsigned long index;
    _BitScanReverse64(&index, word);
    return index;
#elif defined(__GNUC__)
    return 63u - (uint32_t)__builtin_clzll(word);
#else
    uint32_t index = 0;
    for (; word >>= 1;) ++index;
    return index;
#endif
}

#endif
