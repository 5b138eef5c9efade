static void probe(Probe* p) {
    const char *name = "claray_probe_header.h", *text = "#define ANSWER 42\n";
    FILE* other = fopen(name, "w");  // in the working directory, which no one named
    if (other != NULL) fputs("#define ANSWER 41\n", other), fclose(other);
    cl_program main_part = clCreateProgramWithSource(p->context, 1, &p->source, NULL, NULL);
    cl_program header = clCreateProgramWithSource(p->context, 1, &text, NULL, NULL);
    cl_int status = clCompileProgram(main_part, 1, &p->device, "", 1, &header, &name, NULL, NULL);
    remove(name);
    p->program = clLinkProgram(p->context, 1, &p->device, "", 1, &main_part, NULL, NULL, NULL);
    clReleaseProgram(header), clReleaseProgram(main_part);
    must(p, status, "clCompileProgram");
    prepare(p), launch(p, 16384, 64);
}
