/* Relations: paths as sums of births, and their reduction mod p in the basis of births. */
#ifndef ROUNDELAY_RELATIONS_H
#define ROUNDELAY_RELATIONS_H

#include "memory.h"

/* Paths as sums of births ---------------------------------------------------------------- */

static void push_term(rips *state, term added)
{
    if (!GROW(state->heap, state->heap_room, state->heap_size + 1)) return;
    int64_t place = state->heap_size++;
    for (; place > 0 && state->heap[(place - 1) / 2].key < added.key; place = (place - 1) / 2)
        state->heap[place] = state->heap[(place - 1) / 2];
    state->heap[place] = added;
}

static term pop_term(rips *state)
{
    const term top = state->heap[0], last = state->heap[--state->heap_size];
    int64_t place = 0;
    for (int64_t child = 1; child < state->heap_size; child = 2 * place + 1) {
        if (child + 1 < state->heap_size && state->heap[child].key < state->heap[child + 1].key)
            ++child;
        if (state->heap[child].key <= last.key) break;
        state->heap[place] = state->heap[child];
        place = child;
    }
    if (state->heap_size) state->heap[place] = last;
    return top;
}

/* Add the oriented edge from -> to, times the coefficient. */
static void push_edge(rips *state, uint32_t from, uint32_t to, int64_t coefficient)
{
    const uint32_t low = from < to ? from : to, high = from < to ? to : from;
    const term added = {edge_key(state->lengths[low * state->n + high], low, high),
                        from < to ? coefficient : -coefficient};
    push_term(state, added);
}

static int32_t birth_number(const rips *state, uint64_t key)
{
    int64_t low = 0, high = state->born;
    while (low < high) {
        const int64_t middle = (low + high) / 2;
        if (state->births[middle] < key)
            low = middle + 1;
        else
            high = middle;
    }
    return low < state->born && state->births[low] == key ? (int32_t)low : -1;
}

/* Add to a coefficient; a sum that 64 bits do not hold ends the run. */
static void add_checked(rips *state, int64_t *sum, int64_t more)
{
    /* The least number has no negative: it is left out. */
    if (more > 0 ? *sum > INT64_MAX - more : *sum < -INT64_MAX - more)
        state->failed = OUT_OF_RANGE;
    else
        *sum += more;
}

/* Empty the heap into a new column of births, youngest first; 0 if they cancel. */
static int expand(rips *state, float time)
{
    const int64_t before = state->relations.entries;
    while (state->heap_size && !state->failed) {
        term top = pop_term(state);
        while (state->heap_size && state->heap[0].key == top.key)
            add_checked(state, &top.coefficient, pop_term(state).coefficient);
        if (!top.coefficient) continue;
        const uint32_t low = key_low(top.key), high = key_high(top.key);
        const uint32_t through = state->fill[low * state->n + high];
        if (through != NO_VERTEX) {
            push_edge(state, low, through, top.coefficient);
            push_edge(state, through, high, top.coefficient);
            continue;
        }
        const int32_t birth = birth_number(state, top.key);
        if (birth >= 0) append(state, &state->relations, birth, top.coefficient);
    }
    if (state->relations.entries == before || state->failed) return 0;
    close_column(state, &state->relations, time);
    return 1;
}

/* Reduction mod p ------------------------------------------------------------------------ */

static uint32_t inverse(uint32_t value, uint32_t prime)
{
    uint64_t result = 1, base = value;
    for (uint32_t power = prime - 2; power; power >>= 1, base = base * base % prime)
        if (power & 1) result = result * base % prime;
    return prime == 2 ? 1 : (uint32_t)result;
}

static void add_to_row(rips *state, const columns *from, int64_t column, uint32_t factor)
{
    const int64_t prime = state->prime;
    for (int64_t k = from->start[column]; k < from->start[column + 1]; ++k) {
        const int32_t place = from->index[k];
        const int64_t value = (from->value[k] % prime + prime) % prime;
        state->row[place] = (uint32_t)((state->row[place] + factor * (uint64_t)value) % (uint64_t)prime);
        state->marks[place / 64] |= (uint64_t)1 << place % 64;
    }
}

/* The youngest birth with a coefficient in the row, or -1. */
static int64_t youngest(rips *state, int64_t word)
{
    for (; word >= 0; --word)
        while (state->marks[word]) {
            const uint32_t bit = highest_bit(state->marks[word]);
            if (state->row[word * 64 + bit]) return word * 64 + bit;
            state->marks[word] &= ~((uint64_t)1 << bit);
        }
    return -1;
}

static void note_life(rips *state, float life)
{
    if (!state->wanted || life <= state->longest[state->wanted - 1]) return;
    int64_t place = state->wanted - 1;
    for (; place > 0 && state->longest[place - 1] < life; --place)
        state->longest[place] = state->longest[place - 1];
    state->longest[place] = life;
}

static void kill(rips *state, int64_t birth, float time)
{
    const uint32_t scale = inverse(state->row[birth], state->prime);
    for (int64_t word = 0; word <= birth / 64; ++word)
        for (uint64_t left = state->marks[word]; left; left &= left - 1) {
            const int64_t place = word * 64 + lowest_bit(left);
            if (state->row[place])
                append(state, &state->reduced, (int32_t)place,
                       (int64_t)((uint64_t)state->row[place] * scale % state->prime));
            state->row[place] = 0;
        }
    memset(state->marks, 0, (size_t)(birth / 64 + 1) * sizeof *state->marks);
    state->killer[birth] = state->reduced.count;
    state->deaths[birth] = time;
    state->ended = state->processed;
    close_column(state, &state->reduced, time);
    note_life(state, time - key_length(state->births[birth]));
    while (state->oldest < state->born && state->killer[state->oldest] >= 0) ++state->oldest;
}

static void reduce(rips *state, float time)
{
    if (!GROW(state->row, state->row_room, state->born)) return;
    if (!GROW(state->marks, state->marks_room, state->born / 64 + 1)) return;
    add_to_row(state, &state->relations, state->relations.count - 1, 1);
    int64_t pivot = youngest(state, state->born / 64);
    while (pivot >= 0 && state->killer[pivot] >= 0) {
        add_to_row(state, &state->reduced, state->killer[pivot], state->prime - state->row[pivot]);
        pivot = youngest(state, pivot / 64);
    }
    if (pivot >= 0) kill(state, pivot, time);
}

#endif
