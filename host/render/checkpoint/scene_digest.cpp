// A digest of a scene without its names.
#include <glm/glm.hpp>

#include "host/bsdf/custom_bsdfs.hpp"
#include "host/render/checkpoint/scene_digest.hpp"
#include "host/scene/members.hpp"

namespace claray {
namespace {

template <class T>
concept Plain = std::is_arithmetic_v<T> || std::is_enum_v<T>;
template <class T>
concept PlainVector = requires(T v) {
    typename T::col_type;
}
|| requires(T v) { T::length(); };

class SceneHasher {
public:
    template <class... T>
    void add(const T&... all) {
        (put(all), ...);
    }
    [[nodiscard]] Digest digest() const { return hasher_.digest(); }

private:
    template <Plain T>
    void put(const T& value) {
        hasher_.add(&value, sizeof value);
    }
    template <PlainVector T>
    void put(const T& value) {
        hasher_.add(&value, sizeof value);
    }
    template <class T>
    void put(const std::optional<T>& value) {
        add(value.has_value());
        if (value) add(*value);
    }
    template <class T>
    void put(const std::vector<T>& values) {
        add(std::uint64_t(values.size()));
        if constexpr (Plain<T> || PlainVector<T>)
            hasher_.add(values.data(), values.size() * sizeof(T));
        else
            for (const T& value : values) add(value);
    }
    void put(const std::string&) {}  // names
    template <Described T>
    void put(const T& value) {
        visit_members(value, [&](const auto&... members) { add(members...); });
        if constexpr (std::is_same_v<T, Material>) put_custom_bsdf(value);
    }
    void put_custom_bsdf(const Material& material) {
        if (material.kind != MaterialKind::custom || material.custom >= custom_bsdfs().size()) return;
        const std::string& source = custom_bsdfs()[material.custom].source;
        hasher_.add(source.data(), source.size());
    }

    Hasher hasher_;
};

}  // namespace

Digest digest_of(const Scene& scene) {
    SceneHasher hasher;
    hasher.add(scene);
    return hasher.digest();
}

}  // namespace claray
