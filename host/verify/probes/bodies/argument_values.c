static void probe(Probe* p) {
    const size_t items = 64;
    build(p, ""), prepare(p);
    for (cl_uint step = 0; step < 65; ++step) {
        must(p, clSetKernelArg(p->kernel, 2, sizeof step, &step), "clSetKernelArg");
        if (step < 64) clEnqueueNDRangeKernel(p->queue, p->kernel, 1, NULL, &items, &items, 0, NULL, NULL);
    }
    launch(p, items, items);
}
