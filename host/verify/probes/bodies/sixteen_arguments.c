static void probe(Probe* p) {
    const cl_float4 four = {{1.5f, 2.5f, 3.5f, 4.5f}};
    build(p, ""), prepare(p);
    for (cl_uint i = 2; i < 7; ++i) argument(p, i);
    p->buffers[7] = clCreateBuffer(p->context, CL_MEM_COPY_HOST_PTR, 4096, p->words, NULL);  // constants may be 64 kB
    must(p, clSetKernelArg(p->kernel, 4, sizeof(cl_mem), &p->buffers[7]), "clSetKernelArg");
    for (cl_uint i = 7; i < 15; ++i) {  // of 1, 2, 4, 8, 1, 2, 4, 8 bytes
        const cl_ulong number = 3 * i;
        must(p, clSetKernelArg(p->kernel, i, (size_t)1 << (i - 7) % 4, &number), "clSetKernelArg");
    }
    must(p, clSetKernelArg(p->kernel, 15, sizeof four, &four), "clSetKernelArg");
    launch(p, 16384, 64);
}
