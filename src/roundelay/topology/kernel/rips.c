/* Persistent cohomology in degrees 0 and 1 by reduced Vietoris-Rips filtrations
 * (Koyama, Memoli, Robins, Turner, arXiv 2307.16333).
 *
 * Edges enter one by one. The lune of an edge is the set of common neighbours by earlier
 * edges. An empty lune: the edge merges two components or gives birth to a class. Else the
 * edge is filled through one vertex of the lune, and every further connected component of
 * the lune gives one relation between earlier edges. Only relations are reduced, in the
 * basis of births, the youngest birth dying (elder rule).
 */
#include <math.h>

#include "buckets.h"
#include "relations.h"

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

/* Components --------------------------------------------------------------------------- */

static uint32_t find_root(rips *state, uint32_t vertex)
{
    while (state->parent[vertex] != vertex)
        vertex = state->parent[vertex] = state->parent[state->parent[vertex]];
    return vertex;
}

static void add_unfilled_edge(rips *state, uint64_t key)
{
    const uint32_t a = find_root(state, key_low(key)), b = find_root(state, key_high(key));
    if (a != b) {
        state->parent[a > b ? a : b] = (uint16_t)(a > b ? b : a);
        state->merges[state->merged++] = key_length(key);
        return;
    }
    if (!GROW(state->births, state->births_room, state->born + 1)) return;
    if (!GROW(state->deaths, state->deaths_room, state->born + 1)) return;
    if (!GROW(state->killer, state->killer_room, state->born + 1)) return;
    state->births[state->born] = key;
    state->deaths[state->born] = INFINITY;
    state->killer[state->born++] = -1;
}

/* Lunes ---------------------------------------------------------------------------------- */

static const uint64_t *row_of(const rips *state, uint32_t vertex)
{
    return state->near + vertex * state->words;
}

static int64_t first_word(const uint64_t *set, int64_t words)
{
    int64_t word = 0;
    while (word < words && !set[word]) ++word;
    return word;
}

static uint32_t take_first(rips *state, uint64_t *set, int64_t word)
{
    const uint32_t bit = lowest_bit(set[word]);
    set[word] &= set[word] - 1;
    return state->vertex[word * 64 + bit];
}

/* rest = the vertices of the lune of a and b that are not near v; 1 if there are any. */
static int leaves_rest(const uint64_t *RESTRICT a, const uint64_t *RESTRICT b,
                       const uint64_t *RESTRICT v, uint64_t *RESTRICT rest, int64_t words)
{
    uint64_t any = 0;
    for (int64_t word = 0; word < words; ++word) any |= rest[word] = a[word] & b[word] & ~v[word];
    return any != 0;
}

/* Take the neighbours of v from rest; 1 if any are left. */
static int shrinks_rest(const uint64_t *RESTRICT v, uint64_t *RESTRICT rest, int64_t words)
{
    uint64_t any = 0;
    for (int64_t word = 0; word < words; ++word) any |= rest[word] &= ~v[word];
    return any != 0;
}

/* Bit position of the first vertex of the lune, outside rest, that is near x; or -1. */
static int64_t first_link(const rips *state, const uint64_t *a, const uint64_t *b, const uint64_t *x)
{
    for (int64_t word = 0; word < state->words; ++word) {
        const uint64_t links = a[word] & b[word] & x[word] & ~state->rest[word];
        if (links) return 64 * word + lowest_bit(links);
    }
    return -1;
}

/* 1 if the lune of a and b is one component, found by a short search: each vertex outside rest
 * is known to be connected, and is used to take the first one of rest. */
static int soon_connected(rips *state, const uint64_t *a, const uint64_t *b)
{
    for (;;) {
        const int64_t word = first_word(state->rest, state->words);
        const uint32_t x = state->vertex[word * 64 + lowest_bit(state->rest[word])];
        const int64_t link = first_link(state, a, b, row_of(state, x));
        if (link < 0) return 0;
        if (!shrinks_rest(row_of(state, state->vertex[link]), state->rest, state->words)) return 1;
    }
}

/* Move the neighbours of v from rest to todo. */
static void reach(rips *state, uint32_t v)
{
    const uint64_t *row = row_of(state, v);
    for (int64_t word = 0; word < state->words; ++word) {
        state->todo[word] |= state->rest[word] & row[word];
        state->rest[word] &= ~row[word];
    }
}

static void relate(rips *state, uint32_t i, uint32_t j, uint32_t through, uint32_t other, float time)
{
    push_edge(state, i, through, 1);
    push_edge(state, through, j, 1);
    push_edge(state, i, other, -1);
    push_edge(state, other, j, -1);
    if (expand(state, time)) reduce(state, time);
}

/* One relation for each component of the lune other than that of the fill vertex. */
static void relate_components(rips *state, uint64_t key, uint32_t through)
{
    const uint64_t *a = row_of(state, key_low(key)), *b = row_of(state, key_high(key));
    for (int64_t word = 0; word < state->words; ++word) {
        state->rest[word] = a[word] & b[word];
        state->todo[word] = 0;
    }
    reach(state, through);
    for (;;) {
        const int64_t rest = first_word(state->rest, state->words);
        if (rest == state->words) return;
        const int64_t todo = first_word(state->todo, state->words);
        if (todo < state->words) {
            reach(state, take_first(state, state->todo, todo));
            continue;
        }
        const uint32_t other = take_first(state, state->rest, rest);
        relate(state, key_low(key), key_high(key), through, other, key_length(key));
        reach(state, other);
    }
}

/* The vertex that last reached a whole lune at i or j, if it is in this lune; else through. */
static uint32_t likely_hub(const rips *state, uint32_t i, uint32_t j, uint32_t through)
{
    const uint64_t *a = row_of(state, i), *b = row_of(state, j);
    const uint32_t hubs[2] = {state->hub[i], state->hub[j]};
    for (int which = 0; which < 2; ++which) {
        const uint32_t label = state->label[hubs[which]];
        if ((a[label / 64] & b[label / 64]) >> label % 64 & 1) return hubs[which];
    }
    return through;
}

static void fill_edge(rips *state, uint64_t key, uint32_t through)
{
    const uint32_t i = key_low(key), j = key_high(key);
    const uint64_t *a = row_of(state, i), *b = row_of(state, j);
    const uint32_t hub = likely_hub(state, i, j, through);
    state->fill[i * state->n + j] = (uint16_t)through;
    if (!leaves_rest(a, b, row_of(state, hub), state->rest, state->words))
        state->hub[i] = state->hub[j] = (uint16_t)hub;
    else if (!soon_connected(state, a, b))
        relate_components(state, key, through);
}

static void add_edge(rips *state, uint64_t key)
{
    const uint32_t i = key_low(key), j = key_high(key);
    uint64_t *a = state->near + i * state->words, *b = state->near + j * state->words;
    int64_t word = 0;
    while (word < state->words && !(a[word] & b[word])) ++word;
    if (word < state->words) {
        fill_edge(state, key, state->vertex[word * 64 + lowest_bit(a[word] & b[word])]);
    } else {
        state->fill[i * state->n + j] = NO_VERTEX;
        add_unfilled_edge(state, key);
    }
    a[state->label[j] / 64] |= (uint64_t)1 << state->label[j] % 64;
    b[state->label[i] / 64] |= (uint64_t)1 << state->label[i] % 64;
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
    state->parent = calloc((size_t)n, sizeof *state->parent);
    state->hub = calloc((size_t)n, sizeof *state->hub);
    state->rest = calloc((size_t)(2 * state->words), sizeof *state->rest);
    state->merges = calloc((size_t)n, sizeof *state->merges);
    state->longest = calloc((size_t)wanted + 1, sizeof *state->longest);
    state->failed = !(state->near && state->vertex && state->parent && state->hub && state->rest &&
                      state->merges && state->longest);
    if (state->failed) return state;
    state->todo = state->rest + state->words;
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
    const float earliest =
        state->oldest < state->born ? key_length(state->births[state->oldest]) : length;
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

static void run_buckets(rips *state, buckets *all, float limit, uint64_t *keys)
{
    scatter(all, state->lengths, state->n, limit, keys);
    for (int64_t bucket = 0; bucket < all->count; ++bucket) {
        sort_bucket(all, keys, bucket);
        if (add_edges(state, keys, all->start[bucket + 1], limit)) return;
    }
}

/* lengths (n, n), upper triangle; label (n): any numbering of the bits, best one in which
 * near points are far apart; keys with room for every edge, ascending on return up to
 * state->processed; fill (n, n). wanted > 0 stops once that many longest bars are settled, and
 * does not even sort what comes after. NULL when memory runs out. */
rips *VARIANT(rips_run)(const float *lengths, int64_t n, const uint16_t *label, float limit,
                        uint32_t prime, int64_t wanted, uint64_t *keys, uint16_t *fill)
{
    buckets all = {0};
    rips *state = start_state(lengths, n, label, wanted);
    if (!state) return NULL;
    state->prime = prime;
    state->fill = fill;
    if (!state->failed) state->failed = !lay_out(&all, lengths, n, limit);
    if (!state->failed) run_buckets(state, &all, limit, keys);
    free_buckets(&all);
    if (!state->failed) return state;
    VARIANT(rips_free)(state);
    return NULL;
}
