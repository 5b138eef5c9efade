// Instances become what the builder takes and what a traversal needs: a box in the world, and the way back into the object.
// The builder takes triangles; an instance enters it as one that spans its box, so that codes, sort, hierarchy, refit and
// validation are those of every other structure. The derivation of the bounds below is in docs/numerics.md.
#include "build/triangles.clh"
#include "claray/shared/instance.h"
#include "trace/moving_instance.clh"

#ifndef GROUP_SIZE
#define GROUP_SIZE 64
#endif

/// A bound on all roundings of a ray's way into an object, relative to |A| |A^-1|, in every kind of arithmetic.
#define PLACEMENT_ERROR (24.0f * UNIT_ROUNDOFF)
/// Beyond this float32 can't carry a ray into the object.
#define LARGEST_WIDENING 0.5f

typedef struct Affine {
    Matrix linear;
    real translation[3];
    float inverse[3][3];  // of the linear part, rounded to float32; not finite where there is none
} Affine;

static inline Affine load_affine(global const Instance* instance) {
    Affine affine;
    affine.linear = load_linear(instance);
    affine.translation[0] = instance->row0[3], affine.translation[1] = instance->row1[3];
    affine.translation[2] = instance->row2[3];
    const Matrix inverse = inverse_of(&affine.linear);
    for (uint i = 0; i < 3; ++i)
        for (uint j = 0; j < 3; ++j) affine.inverse[i][j] = (float)inverse.m[i][j];
    return affine;
}

/// How far, relative to its distance, a point of an object-space ray may lie from the world's ray along one axis: what the
/// rounded inverse lacks, as the residual A * inverse - 1 shows, and the roundings of the transformation.
static inline float error_along(const Affine* affine, uint axis) {
    real error = 0;
    for (uint j = 0; j < 3; ++j) {
        real residual = axis == j ? -1 : 0, size = 0;
        for (uint k = 0; k < 3; ++k) {
            residual = fma(affine->linear.m[axis][k], (real)affine->inverse[k][j], residual);
            size += fabs(affine->linear.m[axis][k] * affine->inverse[k][j]);
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
            valid = valid && fabs(affine->linear.m[i][j]) <= COORDINATE_LIMIT && fabs(affine->inverse[i][j]) <= COORDINATE_LIMIT;
    }
    return valid;
}

// The float below and the float above a value that was rounded to nearest: bounds on what it was.
static inline float bound_below(real value) { return float_from_key(float_key((float)value) - 1); }
static inline float bound_above(real value) { return float_from_key(float_key((float)value) + 1); }

typedef struct Range3 {
    float lo[3], hi[3];
} Range3;

/// The box that holds the transformed `object`, grown along each axis by `errors` of the object's largest distance from its
/// origin.
static inline Range3 place_box(const Affine* affine, const Range3* object, const float errors[3]) {
    Range3 box;
    real below[3], above[3], size[3];
    for (uint i = 0; i < 3; ++i) {
        below[i] = above[i] = affine->translation[i];
        size[i] = 0;
        for (uint k = 0; k < 3; ++k) {
            const real a = affine->linear.m[i][k] * object->lo[k], b = affine->linear.m[i][k] * object->hi[k];
            below[i] += fmin(a, b);
            above[i] += fmax(a, b);
            size[i] += fmax(fabs(a), fabs(b));
        }
    }
    const real largest = fmax(fmax(size[0], size[1]), size[2]);
    for (uint i = 0; i < 3; ++i) {
        const real pad = errors[i] * largest + 8 * REAL_ROUNDOFF * (fabs(affine->translation[i]) + size[i]);
        box.lo[i] = bound_below(below[i] - pad);
        box.hi[i] = bound_above(above[i] + pad);
    }
    return box;
}

/// Three corners that span the box.
static inline void store_corners(global float* corners, const Range3* box) {
    for (uint i = 0; i < 3; ++i) {
        corners[i] = box->lo[i];
        corners[3 + i] = box->hi[i];
        corners[6 + i] = i == 1 ? box->hi[i] : box->lo[i];  // off the diagonal, so that the triangle has an area
    }
}

// Instances that move. Between two times s and t every entry of the matrix lies between its values there, its cofactors are
// polynomials of degree two in the time, its determinant one of degree three: all lie between their Bernstein coefficients, which
// are the polar forms at (s, s), (s, t), (t, t) and so on (Farin 2002, "Curves and Surfaces for CAGD", chapters 3 and 5).

#define MOTION_PIECES 16  // of the time; more of them, tighter bounds
#define MOTION_ERROR (32.0f * UNIT_ROUNDOFF)  // as PLACEMENT_ERROR, with the residual and the interpolation

static inline real larger(real a, real b) { return a > b ? a : b; }

static inline real polar_cofactor(const Matrix* a, const Matrix* b, uint i, uint j) {
    const uint i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
    return 0.5f * (a->m[i1][j1] * b->m[i2][j2] + b->m[i1][j1] * a->m[i2][j2] - a->m[i1][j2] * b->m[i2][j1] -
                   b->m[i1][j2] * a->m[i2][j1]);
}

/// The polar form of the determinant at (a, a, b): b in each row in turn.
static inline real polar_determinant(const Matrix* a, const Matrix* b) {
    real sum = 0;
    for (uint i = 0; i < 3; ++i)
        for (uint j = 0; j < 3; ++j) sum += b->m[i][j] * cofactor(a, i, j);
    return sum / 3;
}

/// The largest that an entry becomes.
static inline real size_of_entry(const Matrix* a, const Matrix* b, uint i, uint j) {
    return larger(fabs(a->m[i][j]), fabs(b->m[i][j]));
}

// The sums of the sizes of what is added and subtracted: roundings are relative to that.
static inline real size_of_cofactor(const Matrix* a, const Matrix* b, uint i, uint j) {
    const uint i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
    return size_of_entry(a, b, i1, j1) * size_of_entry(a, b, i2, j2) + size_of_entry(a, b, i1, j2) * size_of_entry(a, b, i2, j1);
}
static inline real size_of_determinant(const Matrix* a, const Matrix* b) {
    real sum = 0;
    for (uint j = 0; j < 3; ++j) sum += size_of_entry(a, b, 0, j) * size_of_cofactor(a, b, 0, j);
    return sum;
}

/// Grows `errors` to a bound on what error_along gives between two times; infinite where there may be no inverse.
static inline void grow_errors(const Matrix* a, const Matrix* b, float errors[3]) {
    const real d0 = polar_determinant(a, a), d1 = polar_determinant(a, b), d2 = polar_determinant(b, a),
               d3 = polar_determinant(b, b);
    const real rounding = 32 * REAL_ROUNDOFF * size_of_determinant(a, b);
    const real least = fmin(fmin(fabs(d0), fabs(d1)), fmin(fabs(d2), fabs(d3))) - rounding;
    const bool one_sign = (d0 > 0) == (d1 > 0) && (d1 > 0) == (d2 > 0) && (d2 > 0) == (d3 > 0);
    real inverse[3][3];  // its size, and what cofactors lose without float64
    for (uint i = 0; i < 3; ++i)
        for (uint j = 0; j < 3; ++j) {
            const real size = larger(fabs(cofactor(a, i, j)), larger(fabs(polar_cofactor(a, b, i, j)), fabs(cofactor(b, i, j))));
            inverse[j][i] = (size + REAL_ROUNDOFF / UNIT_ROUNDOFF * size_of_cofactor(a, b, i, j)) / least;
        }
    const real lost = 1 + 2 * rounding / (least * MOTION_ERROR);  // by the division by the determinant
    for (uint i = 0; i < 3; ++i) {
        real error = 0;
        for (uint k = 0; k < 3; ++k)
            for (uint j = 0; j < 3; ++j) error += size_of_entry(a, b, i, k) * inverse[k][j];
        errors[i] = one_sign && least > 0 ? fmax(errors[i], (float)(MOTION_ERROR * error * lost)) : INFINITY;
    }
}

static inline bool instance_moves(global const Instance* begin, global const Instance* end) {
    bool same = true;
    for (uint k = 0; k < 4; ++k)
        same = same && begin->row0[k] == end->row0[k] && begin->row1[k] == end->row1[k] && begin->row2[k] == end->row2[k];
    return !same;
}

static inline void grow_errors_of_motion(global const Instance* begin, global const Instance* end, float errors[3]) {
    Matrix at = load_linear(begin);
    for (uint piece = 1; piece <= MOTION_PIECES; ++piece) {
        const Matrix next = linear_at(begin, end, (real)piece / MOTION_PIECES);
        grow_errors(&at, &next, errors);
        at = next;
    }
}

/// Grows the box of an instance by where it goes: its points run on straight lines, so that what holds the ends holds all.
static inline void sweep_box(Range3* box, const Affine* end, const Range3* object, const float errors[3], const Affine* begin) {
    const Range3 last = place_box(end, object, errors);
    real largest = 0;  // distance of a point from the object's origin on the way
    for (uint i = 0; i < 3; ++i) {
        real size = 0;
        for (uint k = 0; k < 3; ++k)
            size += size_of_entry(&begin->linear, &end->linear, i, k) * larger(fabs(object->lo[k]), fabs(object->hi[k]));
        largest = larger(largest, size);
    }
    for (uint i = 0; i < 3; ++i) {
        const real pad = errors[i] * largest;
        box->lo[i] = fmin(bound_below((real)box->lo[i] - pad), bound_below((real)last.lo[i] - pad));
        box->hi[i] = fmax(bound_above((real)box->hi[i] + pad), bound_above((real)last.hi[i] + pad));
    }
}

static inline void store_placed(global PlacedInstance* placed, global const Instance* instance, const Affine* affine, bool moves) {
    for (uint k = 0; k < 3; ++k) {
        placed->row0[k] = affine->inverse[0][k];
        placed->row1[k] = affine->inverse[1][k];
        placed->row2[k] = affine->inverse[2][k];
    }
    placed->row0[3] = instance->row0[3], placed->row1[3] = instance->row1[3], placed->row2[3] = instance->row2[3];
    placed->bottom = instance->bottom;
    placed->mask = instance->mask;
    placed->id = instance->id;
    placed->moves = moves;
}

/// Writes the instance for traversals, and its corners for the builder, NaN where it is to be culled. Returns its widening. `end`
/// may be absent.
static inline float place_instance(global const Instance* instance, global const Instance* end, global const BvhHeader* bottoms,
                                   uint bottom_count, global PlacedInstance* placed, global float* corners) {
    const bool moves = end && instance_moves(instance, end);
    Affine affine = load_affine(instance), affine_end = affine;
    float errors[3];
    for (uint i = 0; i < 3; ++i) errors[i] = error_along(&affine, i);
    if (moves) {
        affine_end = load_affine(end);
        grow_errors_of_motion(instance, end, errors);
    }
    const float widening = fmax(fmax(errors[0], errors[1]), errors[2]);
    store_placed(placed, instance, &affine, moves);
    const bool has_bottom = instance->bottom < bottom_count && bottoms[instance->bottom].valid != 0;
    if (!has_bottom || !affine_valid(&affine) || (moves && !affine_valid(&affine_end)) || !(widening < LARGEST_WIDENING)) {
        corners[0] = NAN;
        return 0.0f;
    }
    global const BvhHeader* header = &bottoms[instance->bottom];
    const Range3 object = {{header->lox, header->loy, header->loz}, {header->hix, header->hiy, header->hiz}};
    Range3 box = place_box(&affine, &object, errors);
    if (moves) sweep_box(&box, &affine_end, &object, errors, &affine);
    store_corners(corners, &box);
    return widening;
}

/// `widening`, zero before, becomes the largest of all instances; of positive floats the bits have the same order. `ends` is
/// absent where nothing moves.
kernel __attribute__((reqd_work_group_size(GROUP_SIZE, 1, 1)))
void place_instances(global const Instance* instances, global const Instance* ends, uint count, global const BvhHeader* bottoms,
                     uint bottom_count, global PlacedInstance* placed, global float* corners, volatile global uint* widening) {
    local uint group_widening;
    if (get_local_id(0) == 0) group_widening = 0;
    barrier(CLK_LOCAL_MEM_FENCE);
    const size_t i = get_global_id(0);
    if (i < count) {
        const float mine = place_instance(&instances[i], ends ? &ends[i] : 0, bottoms, bottom_count, &placed[i], corners + 9 * i);
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
