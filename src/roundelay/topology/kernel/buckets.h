/* Sorting of edges: buckets of nearly equal length, each sorted when it is reached. */
#ifndef ROUNDELAY_BUCKETS_H
#define ROUNDELAY_BUCKETS_H

#include <stdlib.h>

#include "kernel.h"

#define SMALL_SORT 32
#define EDGES_PER_BUCKET 2048
#define MAX_BUCKETS 65536

typedef struct {
    int64_t *start; /* (count + 1) */
    int64_t *next;  /* (count): where the next key goes */
    int64_t count;
    float scale;
    uint64_t *scratch;
} buckets;

static int64_t bucket_of(const buckets *all, float length)
{
    const int64_t which = (int64_t)(length * all->scale);
    return which < all->count ? which : all->count - 1;
}

static void insertion_sort(uint64_t *keys, int64_t count)
{
    for (int64_t i = 1; i < count; ++i) {
        const uint64_t key = keys[i];
        int64_t j = i;
        for (; j > 0 && keys[j - 1] > key; --j) keys[j] = keys[j - 1];
        keys[j] = key;
    }
}

/* Stable, by the bytes of the length: equal lengths arrive in the order of their vertices. */
static void radix_sort(uint64_t *keys, uint64_t *scratch, int64_t count)
{
    uint64_t *from = keys, *to = scratch;
    for (int shift = 32; shift < 64; shift += 8) {
        int64_t place[257] = {0};
        for (int64_t i = 0; i < count; ++i) ++place[(from[i] >> shift & 0xFF) + 1];
        if (place[(from[0] >> shift & 0xFF) + 1] == count) continue;
        for (int digit = 0; digit < 256; ++digit) place[digit + 1] += place[digit];
        for (int64_t i = 0; i < count; ++i) to[place[from[i] >> shift & 0xFF]++] = from[i];
        uint64_t *swap = from;
        from = to;
        to = swap;
    }
    if (from != keys) memcpy(keys, from, (size_t)count * sizeof *keys);
}

static void sort_bucket(const buckets *all, uint64_t *keys, int64_t which)
{
    const int64_t start = all->start[which], count = all->start[which + 1] - start;
    if (count <= SMALL_SORT)
        insertion_sort(keys + start, count);
    else
        radix_sort(keys + start, all->scratch, count);
}

/* Lay out buckets for the edges of length <= limit: bucket b begins at start[b]. */
static int lay_out(buckets *all, const float *lengths, int64_t n, float limit)
{
    int64_t largest = 0;
    for (all->count = 1; all->count < MAX_BUCKETS && all->count * 2 * EDGES_PER_BUCKET < n * n / 2;)
        all->count *= 2;
    all->scale = limit > 0 ? (float)all->count / limit : 0;
    if (!(all->scale < 1e30f)) all->scale = 0;
    all->start = calloc((size_t)all->count + 1, sizeof *all->start);
    if (!all->start) return 0;
    for (int64_t i = 0; i < n; ++i)
        for (int64_t j = i + 1; j < n; ++j)
            if (lengths[i * n + j] <= limit) ++all->start[bucket_of(all, lengths[i * n + j]) + 1];
    for (int64_t b = 1; b <= all->count; ++b) {
        if (all->start[b] > largest) largest = all->start[b];
        all->start[b] += all->start[b - 1];
    }
    all->scratch = malloc((size_t)(largest + 1) * sizeof *all->scratch);
    all->next = malloc((size_t)(all->count + 1) * sizeof *all->next);
    if (all->next) memcpy(all->next, all->start, (size_t)(all->count + 1) * sizeof *all->next);
    return all->scratch && all->next;
}

/* Put the keys of the edges of length <= limit in their buckets. */
static void scatter(buckets *all, const float *lengths, int64_t n, float limit, uint64_t *keys)
{
    for (int64_t i = 0; i < n; ++i)
        for (int64_t j = i + 1; j < n; ++j) {
            const float length = lengths[i * n + j];
            if (length <= limit)
                keys[all->next[bucket_of(all, length)]++] =
                    edge_key(length, (uint32_t)i, (uint32_t)j);
        }
}

static void free_buckets(buckets *all)
{
    free(all->start);
    free(all->next);
    free(all->scratch);
}

#endif
