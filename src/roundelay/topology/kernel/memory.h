/* Growing arrays and columns of a run; a failure is noted in the state and ends the run. */
#ifndef ROUNDELAY_MEMORY_H
#define ROUNDELAY_MEMORY_H

#include <stdlib.h>

#include "rips.h"

static int grow(rips *state, void *array, int64_t *room, int64_t need, size_t size)
{
    void **data = array;
    if (need <= *room) return 1;
    const int64_t wider = need > 2 * *room ? need + 16 : 2 * *room;
    void *moved = realloc(*data, (size_t)wider * size);
    if (!moved) {
        state->failed = OUT_OF_MEMORY;
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

#endif
