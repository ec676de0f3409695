/* The smoothest cocycle of a class: weighted least squares on the graph of short edges. */
#include <math.h>
#include <stdlib.h>

#include "kernel.h"

#define LANES 8

typedef struct {
    int64_t n, words;
    uint64_t *near;          /* (n, words): neighbours */
    const double *weight;    /* (n): an edge weighs weight[i] * weight[j] */
    double *diagonal;        /* (n): sum of the weights at a vertex */
    double *scaled;          /* (64 * words): weight * vector, zero-padded */
} graph;

static double masked_sum(const uint64_t *bits, const double *vector, int64_t words)
{
    double sums[LANES] = {0};
    for (int64_t word = 0; word < words; ++word) {
        const uint64_t set = bits[word];
        if (!set) continue;
        const double *part = vector + 64 * word;
        for (int shift = 0; shift < 64; shift += LANES)
            for (int lane = 0; lane < LANES; ++lane)
                sums[lane] += (set >> (shift + lane) & 1) ? part[shift + lane] : 0.0;
    }
    return ((sums[0] + sums[4]) + (sums[1] + sums[5])) + ((sums[2] + sums[6]) + (sums[3] + sums[7]));
}

static void scale_vector(const graph *g, const double *vector)
{
    for (int64_t i = 0; i < g->n; ++i) g->scaled[i] = g->weight[i] * vector[i];
}

static void apply(const graph *g, const double *vector, double *out)
{
    scale_vector(g, vector);
    for (int64_t i = 0; i < g->n; ++i)
        out[i] = g->diagonal[i] * vector[i] -
                 g->weight[i] * masked_sum(g->near + i * g->words, g->scaled, g->words);
}

static void connect(graph *g, const float *lengths, float scale)
{
    for (int64_t i = 0; i < g->n; ++i)
        for (int64_t j = i + 1; j < g->n; ++j)
            if (lengths[i * g->n + j] <= scale) {
                g->near[i * g->words + j / 64] |= (uint64_t)1 << j % 64;
                g->near[j * g->words + i / 64] |= (uint64_t)1 << i % 64;
            }
}

/* residual = b - L w, where b_i = sum of weight_ij * (value from i to j). */
static void start_residual(const graph *g, const int32_t *values, const double *w, double *residual)
{
    memset(residual, 0, (size_t)g->n * sizeof *residual);
    for (int64_t i = 0; i < g->n; ++i)
        for (int64_t word = i / 64; word < g->words; ++word)
            for (uint64_t set = g->near[i * g->words + word]; set; set &= set - 1) {
                const int64_t j = 64 * word + lowest_bit(set);
                if (j <= i) continue;
                const double flow = g->weight[i] * g->weight[j] * (values[i * g->n + j] + w[j] - w[i]);
                residual[i] += flow;
                residual[j] -= flow;
            }
}

static double largest_value(const graph *g, const int32_t *values, const double *w)
{
    double largest = 0;
    for (int64_t i = 0; i < g->n; ++i)
        for (int64_t word = i / 64; word < g->words; ++word)
            for (uint64_t set = g->near[i * g->words + word]; set; set &= set - 1) {
                const int64_t j = 64 * word + lowest_bit(set);
                if (j <= i) continue;
                const double value = fabs(values[i * g->n + j] + w[j] - w[i]);
                if (value > largest) largest = value;
            }
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
 * Stops when no vertex would move by more than the tolerance. Returns the steps taken. */
static int64_t solve(const graph *g, double tolerance, int64_t most, double *w, double *work)
{
    const int64_t n = g->n;
    double *residual = work, *direction = work + n, *image = work + 2 * n, *ready = work + 3 * n;
    precondition(g, residual, ready);
    memcpy(direction, ready, (size_t)n * sizeof *direction);
    double energy = dot(residual, ready, n);
    int64_t step = 0;
    for (; step < most && largest_of(ready, n) > tolerance; ++step) {
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
    return step;
}

/* Minimise the sum over edges of length <= scale of
 * weight[i] weight[j] (values[i][j] + w[j] - w[i])^2, starting from w.
 * values (n, n), upper triangle. Returns the largest |values[i][j] + w[j] - w[i]|, or -1 when
 * memory runs out; *steps gets the number of iterations. */
double VARIANT(harmonic)(const float *lengths, const int32_t *values, int64_t n, float scale,
                         const double *weight, double tolerance, int64_t most, double *w,
                         int64_t *steps)
{
    graph g = {n, (n + 63) / 64, NULL, weight, NULL, NULL};
    g.near = calloc((size_t)(n * g.words), sizeof *g.near);
    g.diagonal = calloc((size_t)n, sizeof *g.diagonal);
    g.scaled = calloc((size_t)(64 * g.words), sizeof *g.scaled);
    double *work = malloc((size_t)(4 * n) * sizeof *work), largest = -1;
    if (g.near && g.diagonal && g.scaled && work) {
        connect(&g, lengths, scale);
        memcpy(g.scaled, weight, (size_t)n * sizeof *weight);
        for (int64_t i = 0; i < n; ++i)
            g.diagonal[i] = weight[i] * masked_sum(g.near + i * g.words, g.scaled, g.words);
        start_residual(&g, values, w, work);
        *steps = solve(&g, tolerance, most, w, work);
        largest = largest_value(&g, values, w);
    }
    free(g.near);
    free(g.diagonal);
    free(g.scaled);
    free(work);
    return largest;
}
