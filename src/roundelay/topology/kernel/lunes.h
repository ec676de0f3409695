/* Edges: the lune of each, and what it does to components, births and relations. */
#ifndef ROUNDELAY_LUNES_H
#define ROUNDELAY_LUNES_H

#include <math.h>

#include "relations.h"

/* Components --------------------------------------------------------------------------- */

static uint32_t find_root(rips *state, uint32_t vertex)
{
    while (state->parent[vertex] != vertex)
        vertex = state->parent[vertex] = state->parent[state->parent[vertex]];
    return vertex;
}

/* 1 if the edge merges two components. */
static int merges_components(rips *state, uint64_t key)
{
    const uint32_t a = find_root(state, key_low(key)), b = find_root(state, key_high(key));
    if (a == b) return 0;
    state->parent[a > b ? a : b] = (uint16_t)(a > b ? b : a);
    state->merges[state->merged++] = key_length(key);
    return 1;
}

static void add_birth(rips *state, uint64_t key)
{
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

static int any_alive(const rips *state) { return state->oldest < state->born; }

static void fill_edge(rips *state, uint64_t key, uint32_t through)
{
    const uint32_t i = key_low(key), j = key_high(key);
    const uint64_t *a = row_of(state, i), *b = row_of(state, j);
    state->fill[i * state->n + j] = (uint16_t)through;
    if (!any_alive(state)) return;
    const uint32_t hub = likely_hub(state, i, j, through);
    if (!leaves_rest(a, b, row_of(state, hub), state->rest, state->words))
        state->hub[i] = state->hub[j] = (uint16_t)hub;
    else if (!soon_connected(state, a, b))
        relate_components(state, key, through);
}

/* First word in which the rows of both vertices have a bit in common, or the number of words. */
static int64_t first_common(const rips *state, uint32_t i, uint32_t j)
{
    const uint64_t *a = row_of(state, i), *b = row_of(state, j);
    int64_t word = 0;
    while (word < state->words && !(a[word] & b[word])) ++word;
    return word;
}

/* Make both vertices neighbours, or take that back. */
static void flip_neighbours(rips *state, uint32_t i, uint32_t j)
{
    const uint32_t p = state->label[i], q = state->label[j];
    state->near[i * state->words + q / 64] ^= (uint64_t)1 << q % 64;
    state->near[j * state->words + p / 64] ^= (uint64_t)1 << p % 64;
}

static void add_edge(rips *state, uint64_t key)
{
    const uint32_t i = key_low(key), j = key_high(key);
    const uint64_t *a = row_of(state, i), *b = row_of(state, j);
    const int64_t word = first_common(state, i, j);
    if (word < state->words) {
        fill_edge(state, key, state->vertex[word * 64 + lowest_bit(a[word] & b[word])]);
    } else {
        state->fill[i * state->n + j] = NO_VERTEX;
        if (!merges_components(state, key)) add_birth(state, key);
    }
    flip_neighbours(state, i, j);
}

#endif
