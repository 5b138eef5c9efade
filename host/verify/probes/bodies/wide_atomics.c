#include <string.h>
static void probe(Probe* p) {
    char extensions[16000] = "";
    clGetDeviceInfo(p->device, CL_DEVICE_EXTENSIONS, sizeof extensions, extensions, NULL);
    if (!strstr(extensions, "cl_khr_int64_base_atomics")) p->lacks = "64-bit atomics";
    else build(p, ""), prepare(p), launch(p, 16384, 64);
}
