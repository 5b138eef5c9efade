#include <string.h>
static void probe(Probe* p) {
    static const cl_image_format format = {CL_RGBA, CL_UNORM_INT8}; static cl_image_desc desc;
    const size_t origin[3] = {0, 0, 0}, size[3] = {128, 128, 1};
    cl_bool can = CL_FALSE;
    clGetDeviceInfo(p->device, CL_DEVICE_IMAGE_SUPPORT, sizeof can, &can, NULL);
    if (!can) return (void)(p->lacks = "images");
    build(p, ""), prepare(p);
    desc.image_type = CL_MEM_OBJECT_IMAGE2D, desc.image_width = desc.image_height = 128;
    for (cl_uint i = 2; i < 4; ++i) {  // the first is read, the second is written
        p->buffers[i] = clCreateImage(p->context, CL_MEM_COPY_HOST_PTR, &format, &desc, p->words, NULL);
        must(p, clSetKernelArg(p->kernel, i, sizeof(cl_mem), &p->buffers[i]), "clSetKernelArg of an image");
    }
    launch(p, 16384, 64);
    clEnqueueReadImage(p->queue, p->buffers[3], CL_TRUE, origin, size, 0, 0, p->words, 0, NULL, NULL);
    for (cl_uint i = 0; i < 16384; ++i) expect(p, p->words[i] == i * 2654435761u, "the first wrong texel written", i);
}
