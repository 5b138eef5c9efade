// Instances become what the builder takes and what a traversal needs: a box in the world, and the way back into the object.
// The builder takes triangles; an instance enters it as one that spans its box, so that codes, sort, hierarchy, refit and
// validation are those of every other structure. The derivation of the bounds below is in docs/numerics.md.
#include "build/triangles.clh"
#include "claray/shared/instance.h"

#ifndef GROUP_SIZE
#define GROUP_SIZE 64
#endif

/// A bound on all roundings of a ray's way into an object, relative to |A| |A^-1|, in every kind of arithmetic.
#define PLACEMENT_ERROR (24.0f * UNIT_ROUNDOFF)
/// Beyond this float32 can't carry a ray into the object.
#define LARGEST_WIDENING 0.5f

typedef struct Affine {
    real linear[3][3], translation[3];
    float inverse[3][3];  // of the linear part, rounded to float32; not finite where there is none
} Affine;

static inline Affine load_affine(global const Instance* instance) {
    Affine affine;
    for (uint k = 0; k < 4; ++k) {
        const real column[3] = {instance->row0[k], instance->row1[k], instance->row2[k]};
        for (uint i = 0; i < 3; ++i)
            if (k < 3) affine.linear[i][k] = column[i];
            else affine.translation[i] = column[i];
    }
    return affine;
}

/// By cofactors.
static inline void invert(Affine* affine) {
    real cofactors[3][3];
    for (uint i = 0; i < 3; ++i)
        for (uint j = 0; j < 3; ++j) {
            const uint i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            cofactors[i][j] =
                affine->linear[i1][j1] * affine->linear[i2][j2] - affine->linear[i1][j2] * affine->linear[i2][j1];
        }
    real determinant = 0;
    for (uint j = 0; j < 3; ++j) determinant += affine->linear[0][j] * cofactors[0][j];
    for (uint i = 0; i < 3; ++i)
        for (uint j = 0; j < 3; ++j) affine->inverse[i][j] = (float)(cofactors[j][i] / determinant);
}

/// How far, relative to its distance, a point of an object-space ray may lie from the world's ray along one axis: what the
/// rounded inverse lacks, as the residual A * inverse - 1 shows, and the roundings of the transformation.
static inline float error_along(const Affine* affine, uint axis) {
    real error = 0;
    for (uint j = 0; j < 3; ++j) {
        real residual = axis == j ? -1 : 0, size = 0;
        for (uint k = 0; k < 3; ++k) {
            residual = fma(affine->linear[axis][k], (real)affine->inverse[k][j], residual);
            size += fabs(affine->linear[axis][k] * affine->inverse[k][j]);
        }
        error += 2 * fabs(residual) + PLACEMENT_ERROR * size;
    }
    return (float)error;
}

static inline bool affine_valid(const Affine* affine) {
    bool valid = true;  // comparisons are false for NaN
    for (uint i = 0; i < 3; ++i) {
        valid = valid && fabs(affine->translation[i]) <= COORDINATE_LIMIT;
        for (uint j = 0; j < 3; ++j)
            valid = valid && fabs(affine->linear[i][j]) <= COORDINATE_LIMIT && fabs(affine->inverse[i][j]) <= COORDINATE_LIMIT;
    }
    return valid;
}

// The float below and the float above a value that was rounded to nearest: bounds on what it was.
static inline float bound_below(real value) { return float_from_key(float_key((float)value) - 1); }
static inline float bound_above(real value) { return float_from_key(float_key((float)value) + 1); }

/// Three corners that span the box which holds the transformed `lo` .. `hi`, grown along each axis by `errors` of the
/// object's largest distance from its origin.
static inline void store_corners(global float* corners, const Affine* affine, const float lo[3], const float hi[3],
                                 const float errors[3]) {
    real below[3], above[3], size[3];
    for (uint i = 0; i < 3; ++i) {
        below[i] = above[i] = affine->translation[i];
        size[i] = 0;
        for (uint k = 0; k < 3; ++k) {
            const real a = affine->linear[i][k] * lo[k], b = affine->linear[i][k] * hi[k];
            below[i] += fmin(a, b);
            above[i] += fmax(a, b);
            size[i] += fmax(fabs(a), fabs(b));
        }
    }
    const real largest = fmax(fmax(size[0], size[1]), size[2]);
    for (uint i = 0; i < 3; ++i) {
        const real pad = errors[i] * largest + 8 * REAL_ROUNDOFF * (fabs(affine->translation[i]) + size[i]);
        const float l = bound_below(below[i] - pad), h = bound_above(above[i] + pad);
        corners[i] = l;
        corners[3 + i] = h;
        corners[6 + i] = i == 1 ? h : l;  // off the diagonal, so that the triangle has an area
    }
}

static inline void store_placed(global PlacedInstance* placed, global const Instance* instance, const Affine* affine) {
    for (uint k = 0; k < 3; ++k) {
        placed->row0[k] = affine->inverse[0][k];
        placed->row1[k] = affine->inverse[1][k];
        placed->row2[k] = affine->inverse[2][k];
    }
    placed->row0[3] = instance->row0[3], placed->row1[3] = instance->row1[3], placed->row2[3] = instance->row2[3];
    placed->bottom = instance->bottom;
    placed->mask = instance->mask;
    placed->id = instance->id;
    placed->spare = 0;
}

/// Writes the instance for traversals, and its corners for the builder, NaN where it is to be culled. Returns its widening.
static inline float place_instance(global const Instance* instance, global const BvhHeader* bottoms, uint bottom_count,
                                   global PlacedInstance* placed, global float* corners) {
    Affine affine = load_affine(instance);
    invert(&affine);
    float errors[3];
    for (uint i = 0; i < 3; ++i) errors[i] = error_along(&affine, i);
    const float widening = fmax(fmax(errors[0], errors[1]), errors[2]);
    store_placed(placed, instance, &affine);
    const bool has_bottom = instance->bottom < bottom_count && bottoms[instance->bottom].valid != 0;
    if (!has_bottom || !affine_valid(&affine) || !(widening < LARGEST_WIDENING)) {
        corners[0] = NAN;
        return 0.0f;
    }
    global const BvhHeader* header = &bottoms[instance->bottom];
    const float lo[3] = {header->lox, header->loy, header->loz}, hi[3] = {header->hix, header->hiy, header->hiz};
    store_corners(corners, &affine, lo, hi, errors);
    return widening;
}

/// `widening`, zero before, becomes the largest of all instances; of positive floats the bits have the same order.
kernel __attribute__((reqd_work_group_size(GROUP_SIZE, 1, 1)))
void place_instances(global const Instance* instances, uint count, global const BvhHeader* bottoms, uint bottom_count,
                     global PlacedInstance* placed, global float* corners, volatile global uint* widening) {
    local uint group_widening;
    if (get_local_id(0) == 0) group_widening = 0;
    barrier(CLK_LOCAL_MEM_FENCE);
    const size_t i = get_global_id(0);
    if (i < count) {
        const float mine = place_instance(&instances[i], bottoms, bottom_count, &placed[i], corners + 9 * i);
        atomic_max(&group_widening, as_uint(mine));
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    if (get_local_id(0) == 0) atomic_max(widening, group_widening);
}

/// Corner i of the boxes is vertex i.
kernel void number_corners(global uint* indices, uint count) {
    const uint i = get_global_id(0);
    if (i < count) indices[i] = i;
}
