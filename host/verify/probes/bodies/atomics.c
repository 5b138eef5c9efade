#include <string.h>
static void probe(Probe* p) {
    cl_uint found = 0;
    build(p, ""), prepare(p);
    memset(p->words, 0, sizeof p->words), argument(p, 2);
    launch(p, 16384, 64);
    must(p, clEnqueueReadBuffer(p->queue, p->buffers[2], CL_TRUE, 0, 4, &found, 0, NULL, NULL), "read");
    expect(p, found == 16384 * 64, "the counter lacks", 16384 * 64 - (long long)found);
}
