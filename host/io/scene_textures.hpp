// The files that a scene references, and the images that its used materials need.
#pragma once

#include <map>
#include <tuple>
#include <utility>

#include "claray/io.hpp"

namespace claray {

/// Where a file that a scene names is: `name` relative to `folder`. Throws ErrorKind::user with the reason where it is
/// empty, absolute or a URL, or lies outside `root`, be it by ".." or by a link; the message names the file `named_in`,
/// or else `root`. Backslashes part folders, as they do where many MTL files come from.
[[nodiscard]] std::filesystem::path path_in_scene(const std::filesystem::path& root,
                                                  const std::filesystem::path& folder, std::string name,
                                                  const std::filesystem::path& named_in = {});

/// Many files reference others by absolute paths of the machine that wrote them: "C:\maps\wood.png",
/// "/home/me/wood.png". Returns the path of the file of the same name in `folder`; empty if `name` is no such path or
/// there is no such file.
[[nodiscard]] std::filesystem::path namesake_of(const std::filesystem::path& folder, const std::string& name);

/// A URI's %xx as the characters they stand for (RFC 3986, section 2.1).
[[nodiscard]] std::string percent_decoded(const std::string& uri);

/// How an image is read: what its bytes mean, and its sampler.
struct TextureSettings {
    TexelFormat eight_bit = TexelFormat::srgb8;
    Wrap wrap_u = Wrap::repeat, wrap_v = Wrap::repeat;
    Filter filter = Filter::trilinear;
    [[nodiscard]] bool operator<(const TextureSettings& other) const {
        return std::tie(eight_bit, wrap_u, wrap_v, filter) <
               std::tie(other.eight_bit, other.wrap_u, other.wrap_v, other.filter);
    }
};

/// Fills Scene::textures: each image once for each use that reads it differently, and all together within the limit.
class SceneTextures {
public:
    explicit SceneTextures(Scene& scene) : scene_(scene) {}

    /// The index of the texture `key` read by these settings; `decode(eight_bit, room)` makes it where there is none
    /// yet.
    template <class Decode>
    std::uint32_t add(const std::string& key, const TextureSettings& settings, Decode&& decode) {
        const auto [found, is_new] = known_.try_emplace({key, settings}, std::uint32_t(scene_.textures.size()));
        if (is_new) keep(decode(settings.eight_bit, room_), settings);
        return found->second;
    }

private:
    void keep(Texture texture, const TextureSettings& settings);

    Scene& scene_;
    std::size_t room_ = std::size_t(1) << 30;
    std::map<std::pair<std::string, TextureSettings>, std::uint32_t> known_;
};

}  // namespace claray
