/* Ask a kernel the recorded cases, without Python: replay KERNEL CASES ANSWERS.
 *
 * It runs where only the binary's own system is there: under wine, under qemu, on a processor
 * without AVX2. CASES holds what `asked` of tests/topology/recorded.py gives, one after the other;
 * into ANSWERS goes what `answered` gives there, each with its length in front. The number of the
 * kernel's interface is printed.
 */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef _WIN32
#include <windows.h>
#else
#include <dlfcn.h>
#endif

typedef struct {
    int64_t n, d, prime, longest, modulus;
    double limit, tolerance;
} head;

static void (*distances)(const float *, int64_t, const float *, int64_t, int64_t, int, float *);
static void *(*rips_run)(const float *, int64_t, const uint16_t *, float, uint32_t, int64_t,
                         uint64_t *, uint16_t *);
static void (*rips_free)(void *);
static void (*rips_sizes)(const void *, int64_t *);
static void (*rips_bars)(const void *, float *, uint64_t *, float *, int64_t *);
static void (*rips_columns)(const void *, int, int64_t *, int32_t *, int64_t *, float *);
static int (*propagate)(const uint64_t *, int64_t, const uint16_t *, int64_t, const uint64_t *,
                        const int32_t *, int64_t, int32_t, int32_t *);
static double (*harmonic)(const uint64_t *, const int32_t *, int64_t, int64_t, int64_t, double,
                          int64_t, double *);
static int32_t (*interface_number)(void);

static void fail(const char *expected, const char *found)
{
    fprintf(stderr, "replay: expected %s, found %s\n", expected, found);
    exit(1);
}

static void *room(int64_t count, size_t size)
{
    void *made = calloc((size_t)count + 1, size);
    if (!made) fail("memory", "none left");
    return made;
}

static void *function(void *library, const char *name)
{
#ifdef _WIN32
    void *found = (void *)GetProcAddress((HMODULE)library, name);
#else
    void *found = dlsym(library, name);
#endif
    if (!found) fail(name, "no such function in the kernel");
    return found;
}

static void load(const char *path)
{
#ifdef _WIN32
    void *library = (void *)LoadLibraryA(path);
    if (!library) fail("a kernel that can be loaded", path);
#else
    void *library = dlopen(path, RTLD_NOW);
    if (!library) fail("a kernel that can be loaded", dlerror());
#endif
    interface_number = function(library, "roundelay_interface");
    distances = function(library, "roundelay_distances");
    rips_run = function(library, "roundelay_rips_run");
    rips_free = function(library, "roundelay_rips_free");
    rips_sizes = function(library, "roundelay_rips_sizes");
    rips_bars = function(library, "roundelay_rips_bars");
    rips_columns = function(library, "roundelay_rips_columns");
    propagate = function(library, "roundelay_propagate");
    harmonic = function(library, "roundelay_harmonic");
}

static FILE *out;
static int64_t length;

static void answer(const void *data, int64_t count, size_t size)
{
    if (fwrite(data, size, (size_t)count, out) != (size_t)count) fail("room to write", "none");
    length += count * (int64_t)size;
}

static void answer_columns(const void *state, int reduced, int64_t count, int64_t entries)
{
    int64_t *start = room(count + 1, sizeof *start), *value = room(entries, sizeof *value);
    int32_t *index = room(entries, sizeof *index);
    float *time = room(count, sizeof *time);
    rips_columns(state, reduced, start, index, value, time);
    answer(start, count + 1, sizeof *start);
    answer(index, entries, sizeof *index);
    answer(value, entries, sizeof *value);
    answer(time, count, sizeof *time);
    free(start), free(value), free(index), free(time);
}

static void answer_fill(const uint16_t *fill, int64_t n, const uint64_t *keys, int64_t count)
{
    for (int64_t k = 0; k < count; ++k)
        answer(fill + (keys[k] >> 16 & 0xFFFF) * (uint64_t)n + (keys[k] & 0xFFFF), 1, sizeof *fill);
}

static void answer_cocycle(const head *asked, const uint64_t *keys, int64_t count,
                           const uint16_t *fill, const uint64_t *births, int64_t born)
{
    int32_t *given = room(born, sizeof *given), *values = room(count, sizeof *values);
    double *w = room(asked->n, sizeof *w);
    for (int64_t k = 0; k < born; ++k) given[k] = k % 2;
    const int done = propagate(keys, count, fill, asked->n, births, given, born,
                               (int32_t)asked->modulus, values);
    if (done != 1) fail("a cocycle", "a failure");
    const double largest = harmonic(keys, values, count, asked->n, count / 2, asked->tolerance,
                                    4 * asked->n, w);
    answer(values, count, sizeof *values);
    answer(w, asked->n, sizeof *w);
    answer(&largest, 1, sizeof largest);
    free(given), free(values), free(w);
}

static void replay(const head *asked, const float *points, const uint16_t *label)
{
    const int64_t n = asked->n;
    float *lengths = room(n * n, sizeof *lengths);
    uint64_t *keys = room(n * n / 2, sizeof *keys);
    uint16_t *fill = room(n * n, sizeof *fill);
    distances(points, n, points, n, asked->d, 1, lengths);
    void *state = rips_run(lengths, n, label, (float)asked->limit, (uint32_t)asked->prime,
                           asked->longest, keys, fill);
    if (!state) fail("a run", "no memory");
    int64_t sizes[8];
    rips_sizes(state, sizes);
    const int64_t count = sizes[0], merged = sizes[1], born = sizes[2];
    float *merges = room(merged, sizeof *merges), *deaths = room(born, sizeof *deaths);
    uint64_t *births = room(born, sizeof *births);
    int64_t *killer = room(born, sizeof *killer);
    rips_bars(state, merges, births, deaths, killer);
    answer(lengths, n * n, sizeof *lengths);
    answer(keys, count, sizeof *keys);
    answer_fill(fill, n, keys, count);
    answer(merges, merged, sizeof *merges);
    answer(births, born, sizeof *births);
    answer(deaths, born, sizeof *deaths);
    answer(killer, born, sizeof *killer);
    answer_columns(state, 0, sizes[3], sizes[4]);
    answer_columns(state, 1, sizes[5], sizes[6]);
    answer_cocycle(asked, keys, count, fill, births, born);
    rips_free(state);
    free(lengths), free(keys), free(fill), free(merges), free(deaths), free(births), free(killer);
}

static void replay_all(FILE *cases)
{
    head asked;
    while (fread(&asked, sizeof asked, 1, cases) == 1) {
        float *points = room(asked.n * asked.d, sizeof *points);
        uint16_t *label = room(asked.n, sizeof *label);
        const size_t numbers = (size_t)(asked.n * asked.d);
        if (fread(points, sizeof *points, numbers, cases) != numbers) fail("a case", "half");
        if (fread(label, sizeof *label, (size_t)asked.n, cases) != (size_t)asked.n)
            fail("a case", "half");
        const long place = ftell(out);
        length = 0;
        fwrite(&length, sizeof length, 1, out);
        replay(&asked, points, label);
        fseek(out, place, SEEK_SET);
        fwrite(&length, sizeof length, 1, out);
        fseek(out, 0, SEEK_END);
        free(points), free(label);
    }
}

int main(int count, char **words)
{
    if (count != 4) fail("three words: KERNEL CASES ANSWERS", "another number");
    load(words[1]);
    printf("interface %d\n", (int)interface_number());
    FILE *cases = fopen(words[2], "rb");
    out = fopen(words[3], "wb");
    if (!cases || !out) fail("files that can be opened", "one that cannot");
    replay_all(cases);
    fclose(cases);
    if (fclose(out)) fail("room to write", "none");
    return 0;
}
