#include <string.h>
static void probe(Probe* p) {
    static unsigned char expected[65536], pattern[128];
    build(p, ""), prepare(p);
    for (size_t size = 1; size <= 128; size *= 2) {  // of the pattern, in bytes
        for (size_t i = 0; i < size; ++i) pattern[i] = (unsigned char)(37 * i + size);
        memset(expected, 0xee, sizeof expected);
        const size_t from = 3 * size, bytes = 101 * size;
        for (size_t i = 0; i < bytes; ++i) expected[from + i] = pattern[i % size];
        must(p, clEnqueueFillBuffer(p->queue, p->buffers[0], "\xee", 1, 0, 65536, 0, NULL, NULL), "fill by a byte");
        must(p, clEnqueueFillBuffer(p->queue, p->buffers[0], pattern, size, from, bytes, 0, NULL, NULL), "fill");
        must(p, clEnqueueReadBuffer(p->queue, p->buffers[0], CL_TRUE, 0, 65536, p->words, 0, NULL, NULL), "read");
        expect(p, memcmp(p->words, expected, 65536) == 0, "a wrong pattern of so many bytes", (long long)size);
    }
}
