// What the tests of the builders share.
#pragma once

#include <gtest/gtest.h>

#include "claray/bvh.hpp"

namespace claray::test {

Bvh build(const Mesh& mesh, unsigned bits = 63, Layout layout = Layout::binary, Builder builder = Builder::fast);
void expect_valid(const Bvh& bvh);
/// Those of the mesh; of a mesh without triangles nothing is expected.
void expect_bounds(const Bvh& bvh, const Mesh& mesh);
/// Triangles each twice as large as the one before are nearest to their predecessors: clustering would give a chain.
Mesh doubling_triangles();

}  // namespace claray::test
