// What the tests of the builders share.
#pragma once

#include <gtest/gtest.h>

#include "claray/bvh.hpp"

namespace claray::test {

Bvh build(const Mesh& mesh, unsigned bits = 63, Layout layout = Layout::binary, Builder builder = Builder::fast);
void expect_valid(const Bvh& bvh);

}  // namespace claray::test
