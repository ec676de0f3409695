/* Persistent cohomology in degrees 0 and 1 by reduced Vietoris-Rips filtrations
 * (Koyama, Memoli, Robins, Turner, arXiv 2307.16333).
 *
 * Edges enter one by one. The lune of an edge is the set of common neighbours by earlier
 * edges. An empty lune: the edge merges two components or gives birth to a class. Else the
 * edge is filled through one vertex of the lune, and every further connected component of
 * the lune gives one relation between earlier edges. Only relations are reduced, in the
 * basis of births, the youngest birth dying (elder rule). While no class lives, every relation
 * holds already: then only the next birth is looked for.
 */
#include "buckets.h"
#include "lunes.h"

#define AHEAD 6

void VARIANT(rips_free)(rips *state)
{
    if (!state) return;
    free(state->near);
    free(state->vertex);
    free(state->parent);
    free(state->hub);
    free(state->rest);
    free(state->merges);
    free(state->births);
    free(state->deaths);
    free(state->killer);
    free_columns(&state->relations);
    free_columns(&state->reduced);
    free(state->heap);
    free(state->row);
    free(state->marks);
    free(state->longest);
    free(state);
}

/* The run ---------------------------------------------------------------------------------- */

static rips *start_state(const float *lengths, int64_t n, const uint16_t *label, int64_t wanted)
{
    rips *state = calloc(1, sizeof *state);
    if (!state) return NULL;
    state->lengths = lengths;
    state->n = n;
    state->label = label;
    state->words = (n + 255) / 256 * 4;
    state->wanted = wanted;
    state->near = calloc((size_t)(n * state->words), sizeof *state->near);
    state->vertex = calloc((size_t)(state->words * 64), sizeof *state->vertex);
    state->parent = calloc((size_t)(2 * n), sizeof *state->parent);
    state->hub = calloc((size_t)n, sizeof *state->hub);
    state->rest = calloc((size_t)(2 * state->words), sizeof *state->rest);
    state->merges = calloc((size_t)n, sizeof *state->merges);
    state->longest = calloc((size_t)wanted + 1, sizeof *state->longest);
    state->failed = !(state->near && state->vertex && state->parent && state->hub && state->rest &&
                      state->merges && state->longest);
    if (state->failed) return state;
    state->todo = state->rest + state->words;
    state->saved = state->parent + n;
    for (int64_t i = 0; i < n; ++i) {
        state->vertex[label[i]] = (uint16_t)i;
        state->parent[i] = (uint16_t)i;
        state->near[i * state->words + label[i] / 64] |= (uint64_t)1 << label[i] % 64;
    }
    (void)GROW(state->relations.start, state->relations.start_room, 1);
    (void)GROW(state->reduced.start, state->reduced.start_room, 1);
    return state;
}

/* True when no living or future class can outlive the wanted ones. */
static int settled(const rips *state, float length, float limit)
{
    if (!state->wanted || state->merged < state->n - 1) return 0;
    const float earliest = any_alive(state) ? key_length(state->births[state->oldest]) : length;
    return limit - earliest < state->longest[state->wanted - 1];
}

/* Add the edges of one sorted bucket; 1 to stop. */
static int add_edges(rips *state, const uint64_t *keys, int64_t last, float limit)
{
    while (state->processed < last) {
        const int64_t edge = state->processed++;
        if (edge + AHEAD < last) {
            const uint64_t ahead = keys[edge + AHEAD];
            PREFETCH(state->fill + key_low(ahead) * state->n + key_high(ahead));
        }
        add_edge(state, keys[edge]);
        if (state->failed || settled(state, key_length(keys[edge]), limit)) return 1;
    }
    return 0;
}

static int is_filled(const rips *state, uint64_t key)
{
    return first_common(state, key_low(key), key_high(key)) < state->words;
}

static void flip_edges(rips *state, const uint64_t *keys, int64_t first, int64_t last)
{
    for (int64_t edge = first; edge < last; ++edge)
        flip_neighbours(state, key_low(keys[edge]), key_high(keys[edge]));
}

/* Make the edges of a bucket neighbours and return 1, unless one gives birth. Most often the
 * earlier buckets fill each edge; else the order within the bucket must tell. */
static int adds_idle(rips *state, const buckets *all, uint64_t *keys, int64_t bucket)
{
    const int64_t first = all->start[bucket], last = all->start[bucket + 1];
    int64_t edge = first;
    while (edge < last && is_filled(state, keys[edge])) ++edge;
    if (edge == last) {
        flip_edges(state, keys, first, last);
        return 1;
    }
    sort_bucket(all, keys, bucket);
    for (edge = first; edge < last; ++edge) {
        if (!is_filled(state, keys[edge]) && !merges_components(state, keys[edge])) break;
        flip_edges(state, keys, edge, edge + 1);
    }
    if (edge == last) return 1;
    flip_edges(state, keys, first, edge);
    return 0;
}

/* The bucket after the last in which a class could be born that outlives the wanted ones; one
 * more, lest rounding matters. */
static int64_t last_bucket(const rips *state, const buckets *all, float limit)
{
    if (!state->wanted || state->merged < state->n - 1) return all->count;
    const int64_t last = bucket_of(all, limit - state->longest[state->wanted - 1]) + 2;
    return last < all->count ? last : all->count;
}

/* While no class lives, only births matter: return the first bucket from this one on that holds
 * one, or all->count if none does. The buckets between need not be sorted, unless one follows:
 * then the state is again what it was. */
static int64_t skip_idle(rips *state, const buckets *all, uint64_t *keys, int64_t bucket, float limit)
{
    const int64_t merged = state->merged;
    int64_t next = bucket;
    memcpy(state->saved, state->parent, (size_t)state->n * sizeof *state->parent);
    while (next < last_bucket(state, all, limit) && adds_idle(state, all, keys, next)) ++next;
    if (next >= last_bucket(state, all, limit)) return all->count;
    flip_edges(state, keys, all->start[bucket], all->start[next]);
    memcpy(state->parent, state->saved, (size_t)state->n * sizeof *state->parent);
    state->merged = merged;
    return next;
}

static void run_buckets(rips *state, buckets *all, float limit, uint64_t *keys)
{
    scatter(all, state->lengths, state->n, limit, keys);
    for (int64_t bucket = 0; bucket < all->count;) {
        const int64_t next = any_alive(state) ? bucket : skip_idle(state, all, keys, bucket, limit);
        if (next == all->count) return;
        for (; bucket <= next; ++bucket) {
            sort_bucket(all, keys, bucket);
            if (add_edges(state, keys, all->start[bucket + 1], limit)) return;
        }
    }
}

/* lengths (n, n), upper triangle; label (n): any numbering of the bits, best one in which
 * near points are far apart; keys with room for every edge, ascending on return up to
 * state->processed, the last death if no class outlives the run; fill (n, n). wanted > 0 stops
 * once that many longest bars are settled. NULL when memory runs out; a coefficient out of range
 * is noted in the state. */
rips *VARIANT(rips_run)(const float *lengths, int64_t n, const uint16_t *label, float limit,
                        uint32_t prime, int64_t wanted, uint64_t *keys, uint16_t *fill)
{
    buckets all = {0};
    rips *state = start_state(lengths, n, label, wanted);
    if (!state) return NULL;
    state->prime = prime;
    state->fill = fill;
    if (!state->failed) state->failed = lay_out(&all, lengths, n, limit) ? WHOLE : OUT_OF_MEMORY;
    if (!state->failed) run_buckets(state, &all, limit, keys);
    if (!any_alive(state)) state->processed = state->ended;
    free_buckets(&all);
    if (state->failed != OUT_OF_MEMORY) return state;
    VARIANT(rips_free)(state);
    return NULL;
}
