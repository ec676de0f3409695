/* The smoothest cocycle of a class: weighted least squares on the graph of short edges. */
#include <math.h>
#include <stdlib.h>

#include "kernel.h"

#define LANES 8

typedef struct {
    int64_t n, count;
    const uint64_t *keys;    /* (count): the edges */
    const int32_t *values;   /* (count): the cocycle from the lower to the higher vertex */
    int64_t *start;          /* (n + 1): where the neighbours of a vertex begin */
    uint16_t *near;          /* (2 * count): neighbours */
    double *weight;          /* (n): an edge weighs weight[i] * weight[j] */
    double *diagonal;        /* (n): sum of the weights at a vertex */
    double *scaled;          /* (n): weight * vector */
} graph;

/* weight[i] = 1 / (1 + edges of i among the first close ones): inverse local density. */
static void weigh(graph *g, int64_t close)
{
    for (int64_t i = 0; i < g->n; ++i) g->weight[i] = 1;
    for (int64_t k = 0; k < close; ++k) {
        ++g->weight[key_low(g->keys[k])];
        ++g->weight[key_high(g->keys[k])];
    }
    for (int64_t i = 0; i < g->n; ++i) g->weight[i] = 1 / g->weight[i];
}

/* List the neighbours of each vertex; start[i] is shifted by one while they are filled in. */
static void connect(graph *g)
{
    for (int64_t k = 0; k < g->count; ++k) {
        ++g->start[key_low(g->keys[k]) + 2];
        ++g->start[key_high(g->keys[k]) + 2];
    }
    for (int64_t i = 2; i <= g->n; ++i) g->start[i] += g->start[i - 1];
    for (int64_t k = 0; k < g->count; ++k) {
        const uint32_t i = key_low(g->keys[k]), j = key_high(g->keys[k]);
        g->near[g->start[i + 1]++] = (uint16_t)j;
        g->near[g->start[j + 1]++] = (uint16_t)i;
    }
}

static double sum_near(const graph *g, int64_t i)
{
    double sums[4] = {0};
    int64_t k = g->start[i];
    for (; k + 4 <= g->start[i + 1]; k += 4)
        for (int lane = 0; lane < 4; ++lane) sums[lane] += g->scaled[g->near[k + lane]];
    for (; k < g->start[i + 1]; ++k) sums[0] += g->scaled[g->near[k]];
    return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

/* out = L vector */
static void apply(const graph *g, const double *vector, double *out)
{
    for (int64_t i = 0; i < g->n; ++i) g->scaled[i] = g->weight[i] * vector[i];
    for (int64_t i = 0; i < g->n; ++i)
        out[i] = g->diagonal[i] * vector[i] - g->weight[i] * sum_near(g, i);
}

static void fill_diagonal(graph *g)
{
    memcpy(g->scaled, g->weight, (size_t)g->n * sizeof *g->weight);
    for (int64_t i = 0; i < g->n; ++i) g->diagonal[i] = g->weight[i] * sum_near(g, i);
}

static double change(const graph *g, int64_t k, const double *w)
{
    return g->values[k] + w[key_high(g->keys[k])] - w[key_low(g->keys[k])];
}

/* residual = b - L w, where b_i = sum of weight_ij * (value from i to j). */
static void start_residual(const graph *g, const double *w, double *residual)
{
    memset(residual, 0, (size_t)g->n * sizeof *residual);
    for (int64_t k = 0; k < g->count; ++k) {
        const uint32_t i = key_low(g->keys[k]), j = key_high(g->keys[k]);
        const double flow = g->weight[i] * g->weight[j] * change(g, k, w);
        residual[i] += flow;
        residual[j] -= flow;
    }
}

static double largest_change(const graph *g, const double *w)
{
    double largest = 0;
    for (int64_t k = 0; k < g->count; ++k) largest = fmax(largest, fabs(change(g, k, w)));
    return largest;
}

static double dot(const double *a, const double *b, int64_t n)
{
    double sums[LANES] = {0};
    int64_t i = 0;
    for (; i + LANES <= n; i += LANES)
        for (int lane = 0; lane < LANES; ++lane) sums[lane] += a[i + lane] * b[i + lane];
    for (; i < n; ++i) sums[0] += a[i] * b[i];
    return ((sums[0] + sums[4]) + (sums[1] + sums[5])) + ((sums[2] + sums[6]) + (sums[3] + sums[7]));
}

static void precondition(const graph *g, const double *residual, double *out)
{
    for (int64_t i = 0; i < g->n; ++i)
        out[i] = g->diagonal[i] > 0 ? residual[i] / g->diagonal[i] : 0.0;
}

static double largest_of(const double *vector, int64_t n)
{
    double largest = 0;
    for (int64_t i = 0; i < n; ++i) largest = fabs(vector[i]) > largest ? fabs(vector[i]) : largest;
    return largest;
}

/* Preconditioned conjugate gradients from w; work holds four vectors, the residual first.
 * Stops when no vertex would move by more than the tolerance. */
static void solve(const graph *g, double tolerance, int64_t most, double *w, double *work)
{
    const int64_t n = g->n;
    double *residual = work, *direction = work + n, *image = work + 2 * n, *ready = work + 3 * n;
    precondition(g, residual, ready);
    memcpy(direction, ready, (size_t)n * sizeof *direction);
    double energy = dot(residual, ready, n);
    for (int64_t step = 0; step < most && largest_of(ready, n) > tolerance; ++step) {
        apply(g, direction, image);
        const double curvature = dot(direction, image, n);
        if (!(curvature > 0)) break;
        const double length = energy / curvature;
        for (int64_t i = 0; i < n; ++i) w[i] += length * direction[i];
        for (int64_t i = 0; i < n; ++i) residual[i] -= length * image[i];
        precondition(g, residual, ready);
        const double next = dot(residual, ready, n), ratio = next / energy;
        energy = next;
        for (int64_t i = 0; i < n; ++i) direction[i] = ready[i] + ratio * direction[i];
    }
}

/* Minimise the sum over the edges of weight[i] weight[j] (value + w[j] - w[i])^2, from w on, with
 * the weights 1 / local density, counted on the first close edges (all 1 when that is 0).
 * Returns the largest |value + w[j] - w[i]|, or -1 when memory runs out. */
double VARIANT(harmonic)(const uint64_t *keys, const int32_t *values, int64_t count, int64_t n,
                         int64_t close, double tolerance, int64_t most, double *w)
{
    double largest = -1;
    double *room = malloc((size_t)(7 * n) * sizeof *room);
    graph g = {n, count, keys, values, calloc((size_t)n + 2, sizeof *g.start),
               malloc((size_t)(2 * count + 1) * sizeof *g.near), room, NULL, NULL};
    if (room && g.start && g.near) {
        g.diagonal = room + n;
        g.scaled = room + 2 * n;
        weigh(&g, close);
        connect(&g);
        fill_diagonal(&g);
        start_residual(&g, w, room + 3 * n);
        solve(&g, tolerance, most, w, room + 3 * n);
        largest = largest_change(&g, w);
    }
    free(room);
    free(g.start);
    free(g.near);
    return largest;
}
