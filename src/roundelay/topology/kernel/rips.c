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
#include <stdlib.h>

#include "rips.h"

#define SMALL_SORT 32
#define EDGES_PER_BUCKET 2048
#define MAX_BUCKETS 65536
#define STAGES 5
#define AHEAD 6

/* Memory ------------------------------------------------------------------------------- */

static int grow(rips *state, void *array, int64_t *room, int64_t need, size_t size)
{
    void **data = array;
    if (need <= *room) return 1;
    const int64_t wider = need > 2 * *room ? need + 16 : 2 * *room;
    void *moved = realloc(*data, (size_t)wider * size);
    if (!moved) {
        state->failed = 1;
        return 0;
    }
    memset((char *)moved + (size_t)*room * size, 0, (size_t)(wider - *room) * size);
    *data = moved;
    *room = wider;
    return 1;
}

#define GROW(array, room, need) grow(state, &(array), &(room), (need), sizeof *(array))

static void append(rips *state, columns *to, int32_t index, int64_t value)
{
    if (!GROW(to->index, to->index_room, to->entries + 1)) return;
    if (!GROW(to->value, to->value_room, to->entries + 1)) return;
    to->index[to->entries] = index;
    to->value[to->entries++] = value;
}

static void close_column(rips *state, columns *to, float time)
{
    if (!GROW(to->start, to->start_room, to->count + 2)) return;
    if (!GROW(to->time, to->time_room, to->count + 1)) return;
    to->time[to->count++] = time;
    to->start[to->count] = to->entries;
}

static void free_columns(columns *which)
{
    free(which->start);
    free(which->index);
    free(which->value);
    free(which->time);
}

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

/* Sorting: buckets of nearly equal length, each sorted when it is reached --------------- */

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

/* Put the keys of the buckets from first to last (not included) in their places. */
static void scatter(buckets *all, const float *lengths, int64_t n, float limit, int64_t first,
                    int64_t last, uint64_t *keys)
{
    for (int64_t i = 0; i < n; ++i)
        for (int64_t j = i + 1; j < n; ++j) {
            const float length = lengths[i * n + j];
            if (!(length <= limit)) continue;
            const int64_t bucket = bucket_of(all, length);
            if (bucket >= first && bucket < last)
                keys[all->next[bucket]++] = edge_key(length, (uint32_t)i, (uint32_t)j);
        }
}

/* The bucket before which at most a share of the edges lies, but at least one past first. */
static int64_t stage_end(const buckets *all, int64_t first, int64_t stages)
{
    const int64_t most = all->start[first] + all->start[all->count] / stages;
    int64_t last = first + 1;
    while (last < all->count && all->start[last + 1] <= most) ++last;
    return last;
}

static void free_buckets(buckets *all)
{
    free(all->start);
    free(all->next);
    free(all->scratch);
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

/* Empty the heap into a new column of births, youngest first; 0 if they cancel. */
static int expand(rips *state, float time)
{
    const int64_t before = state->relations.entries;
    while (state->heap_size && !state->failed) {
        term top = pop_term(state);
        while (state->heap_size && state->heap[0].key == top.key)
            top.coefficient += pop_term(state).coefficient;
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

static void run_stages(rips *state, buckets *all, float limit, uint64_t *keys)
{
    int64_t end = 0;
    for (int64_t bucket = 0; bucket < all->count; ++bucket) {
        if (bucket == end) {
            end = stage_end(all, bucket, state->wanted ? STAGES : 1);
            scatter(all, state->lengths, state->n, limit, bucket, end, keys);
        }
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
    if (!state->failed) run_stages(state, &all, limit, keys);
    free_buckets(&all);
    if (!state->failed) return state;
    VARIANT(rips_free)(state);
    return NULL;
}

/* Cocycles ---------------------------------------------------------------------------------- */

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
