static void build(Probe* p, const char* options) {
    char log[1900] = "clBuildProgram";
    p->program = clCreateProgramWithSource(p->context, 1, &p->source, NULL, NULL);
    cl_int status = clBuildProgram(p->program, 1, &p->device, options, NULL, NULL);
    if (status) clGetProgramBuildInfo(p->program, p->device, CL_PROGRAM_BUILD_LOG, sizeof log - 1, log, NULL);
    must(p, status, log);
}
static void argument(Probe* p, cl_uint at) {  // a buffer with the words
    p->buffers[at] = clCreateBuffer(p->context, CL_MEM_COPY_HOST_PTR, sizeof p->words, p->words, NULL);
    must(p, clSetKernelArg(p->kernel, at, sizeof(cl_mem), &p->buffers[at]), "clSetKernelArg");
}
static void prepare(Probe* p) {  // the kernel, with words and results
    for (cl_uint i = 0; i < 65536; ++i) p->words[i] = (i * 2654435761u) ^ (i * 2246822519u >> 15);
    p->kernel = clCreateKernel(p->program, "probe", NULL), argument(p, 0), argument(p, 1);
}
static void launch(Probe* p, size_t items, size_t group) {  // each item's result is how many things are wrong
    must(p, clEnqueueNDRangeKernel(p->queue, p->kernel, 1, NULL, &items, &group, 0, NULL, NULL), "launch");
    must(p, clEnqueueReadBuffer(p->queue, p->buffers[1], CL_TRUE, 0, items * 4, p->words, 0, NULL, NULL), "read");
    for (size_t i = 0; i < items; ++i) expect(p, p->words[i] == 0, "the first wrong item", (long long)i);
}
