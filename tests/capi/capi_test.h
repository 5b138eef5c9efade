/* What the tests of claray.h share. They are C99, and C++ as well. */
#ifndef CAPI_TEST_H
#define CAPI_TEST_H

#include <CL/cl.h>
#include <claray.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

extern int failures;

#define EXPECT(condition)                                                                               \
    do {                                                                                                \
        if (!(condition)) {                                                                             \
            printf("%s:%d: %s; last error: %s\n", __FILE__, __LINE__, #condition, claray_last_error()); \
            ++failures;                                                                                 \
        }                                                                                               \
    } while (0)
#define EXPECT_ERROR(call, status, words)                     \
    do {                                                      \
        EXPECT((call) == (status));                           \
        EXPECT(strstr(claray_last_error(), (words)) != NULL); \
    } while (0)

/* A struct of the caller's version. */
#define STRUCT(type, name) \
    type name = {0};       \
    name.struct_size = sizeof name

claray_mesh square_mesh(void);
claray_bvh* corner_of(claray_device* device);
/* A textured floor at z = 0 below a lamp, seen from z = 4. */
claray_scene* lit_floor(void);

void test_devices(claray_device* device);
void test_more_queries(claray_device* device);
void test_scenes(claray_device* device);
void test_renders(claray_device* device);
void test_results(claray_device* device);
void test_targets(claray_device* device);
void test_sensors(claray_device* device);
void test_bsdf(claray_device* device); /* the last one: programs that are compiled later have its BSDF */

#endif
