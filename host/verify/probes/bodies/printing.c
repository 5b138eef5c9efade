#include <string.h>
#include <unistd.h>
static void probe(Probe* p) {
    const char* expected = "-7 4000000000 0x1f 1.50 a text % 1.00,2.00,3.00,4.00\n";
    char found[200] = "";
    build(p, ""), prepare(p), fflush(stdout);
    FILE* file = tmpfile();
    const int output = dup(1);
    if (file == NULL || dup2(fileno(file), 1) < 0) must(p, -1, "tmpfile");
    const cl_int status = clEnqueueTask(p->queue, p->kernel, 0, NULL, NULL);
    clFinish(p->queue), fflush(stdout), dup2(output, 1), close(output), rewind(file);
    found[fread(found, 1, sizeof found - 1, file)] = 0, fclose(file);
    must(p, status, "clEnqueueTask");
    expect(p, strcmp(found, expected) == 0, found, 0);
}
