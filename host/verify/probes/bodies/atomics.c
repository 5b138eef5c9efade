#include <string.h>
static void probe(Probe* p) {
    static cl_uint found[64];
    build(p, ""), prepare(p);
    memset(p->words, 0, sizeof p->words), argument(p, 2);
    launch(p, 16384, 64);
    // every item adds 1 to each of 64 counters, which all groups share
    must(p, clEnqueueReadBuffer(p->queue, p->buffers[2], CL_TRUE, 0, sizeof found, found, 0, NULL, NULL), "read");
    for (int i = 0; i < 64; ++i) expect(p, found[i] == 16384, "the first wrong counter", i);
}
