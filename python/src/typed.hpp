// Types that the stub of the module tells whole, so that type checkers know what results hold.
#pragma once

#include <nanobind/nanobind.h>

namespace claray::python {

using Dict = nanobind::typed<nanobind::dict, nanobind::str, nanobind::any>;
using List = nanobind::typed<nanobind::list, nanobind::any>;
using Tuple = nanobind::typed<nanobind::tuple, nanobind::any, nanobind::ellipsis>;

}  // namespace claray::python
