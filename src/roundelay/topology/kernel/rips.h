/* The state of one run, read out by dispatch.c. */
#ifndef ROUNDELAY_RIPS_H
#define ROUNDELAY_RIPS_H

#include "kernel.h"

typedef struct {
    uint64_t key;
    int64_t coefficient;
} term;

typedef struct {
    int64_t *start; /* (count + 1): where each column's entries begin */
    int32_t *index; /* birth numbers */
    int64_t *value;
    float *time; /* (count): length of the edge that brought the relation */
    int64_t count, entries, start_room, time_room, index_room, value_room;
} columns;

struct rips {
    const float *lengths; /* (n, n), upper triangle */
    int64_t n, words;
    int64_t processed;        /* edges so far */
    int64_t ended;            /* edges up to the last death */
    uint32_t prime;
    uint64_t *near;           /* (n, words): bit label[j] of row i: edge ij is in, or i = j */
    const uint16_t *label;    /* (n): bit position of a vertex */
    uint16_t *vertex;         /* (n): vertex of a bit position */
    uint16_t *parent, *saved; /* (n): union-find forest, and as it was before a skip */
    uint16_t *hub;            /* (n): the vertex that last reached all of a lune here */
    uint16_t *fill;           /* (n, n), upper triangle */
    uint64_t *rest, *todo;    /* (words): one lune's vertices */
    float *merges;            /* (n - 1): deaths of components */
    int64_t merged;
    uint64_t *births;         /* (born): keys, ascending */
    float *deaths;            /* (born): infinity while alive */
    int64_t *killer;          /* (born): number of the reduced column, or -1 */
    int64_t born, oldest, births_room, deaths_room, killer_room;
    columns relations;        /* over the integers, as found */
    columns reduced;          /* mod prime, pivot (youngest birth) last, with value 1 */
    term *heap;
    int64_t heap_size, heap_room;
    uint32_t *row;            /* (row_room): one relation mod prime, dense */
    uint64_t *marks;          /* its non-zero places */
    int64_t row_room, marks_room;
    float *longest;           /* (wanted): the longest lives so far, descending */
    int64_t wanted;
    int failed;               /* WHOLE, or why not */
};

#endif
