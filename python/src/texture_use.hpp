// TextureUse in Python: None, the number of a texture, or a tuple (texture, uv_set, offset, scale, rotation).
#pragma once

#include <nanobind/stl/tuple.h>

#include "claray/texture.hpp"
#include "vectors.hpp"

namespace nanobind::detail {

template <>
struct type_caster<claray::TextureUse> {
    using Members = std::tuple<std::uint32_t, std::uint32_t, glm::vec2, glm::vec2, float>;
    NB_TYPE_CASTER(claray::TextureUse,
                   const_name("tuple[int, int, tuple[float, ...], tuple[float, ...], float] | int | None"))

    bool from_python(handle source, uint8_t flags, cleanup_list* cleanup) noexcept {
        value = {};
        if (source.is_none()) return true;
        make_caster<std::uint32_t> number;
        if (PyLong_Check(source.ptr())) {
            if (!number.from_python(source, flags, cleanup)) return false;
            value.texture = number.operator cast_t<std::uint32_t>();
            return true;
        }
        make_caster<Members> members;
        if (!members.from_python(source, flags, cleanup)) return false;
        const Members given = members.operator cast_t<Members>();
        value = {std::get<0>(given), std::get<1>(given), std::get<2>(given), std::get<3>(given), std::get<4>(given)};
        return true;
    }
    static handle from_cpp(const claray::TextureUse& use, rv_policy policy, cleanup_list* cleanup) noexcept {
        if (!use.used()) return none().release();
        const Members members(use.texture, use.uv_set, use.offset, use.scale, use.rotation);
        return make_caster<Members>::from_cpp(members, policy, cleanup);
    }
};

}  // namespace nanobind::detail
