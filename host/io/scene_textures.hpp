// The files that a scene references, and the images that its used materials need.
#pragma once

#include <map>
#include <optional>
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

/// Many files reference others by paths of the machine that wrote them: "C:\maps\wood.png", "/home/me/wood.png",
/// "../maps/wood.png". Returns the path of the file of the same name in `folder`; empty if `name` leads to a file in
/// `folder` or below, or there is no such file.
[[nodiscard]] std::filesystem::path namesake_of(const std::filesystem::path& folder, const std::string& name);

/// A warning that `namesake` is read instead of the file `name`, which `scene` asks for.
[[nodiscard]] std::string remark_of_namesake(const std::filesystem::path& scene, const std::string& name,
                                             const std::filesystem::path& namesake);

/// The bytes of an image that a scene names, and what to call it in messages.
struct ImageFile {
    std::string name;  ///< its path in quotation marks
    std::string bytes;
};

/// Reads the image `name` of the file `scene`, relative to `folder`. A file of the same name in `folder` stands in for
/// one that is not where its name leads, with a warning. Where there is none either, or the name leads out of the
/// scene's folder: a warning, and nothing. Throws where the file cannot be read.
[[nodiscard]] std::optional<ImageFile> read_image_of_scene(const std::filesystem::path& scene,
                                                           const std::filesystem::path& folder, const std::string& name,
                                                           Warnings& warnings);

/// Turns a material grey whose image of colours is missing.
void show_missing(Material& material);

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

/// Bytes that all textures of a scene may take.
inline constexpr std::size_t room_for_textures = std::size_t(1) << 30;

/// Fills Scene::textures: each image once for each use that reads it differently, and all together within the limit.
class SceneTextures {
public:
    explicit SceneTextures(Scene& scene) : scene_(scene) {}

    /// The index of the texture `key` read by these settings; `decode(eight_bit, room)` makes it where there is none
    /// yet. Nothing where that gives nothing.
    template <class Decode>
    std::optional<std::uint32_t> add(const std::string& key, const TextureSettings& settings, Decode&& decode) {
        const auto [found, is_new] = known_.try_emplace({key, settings});
        if (!is_new) return found->second;
        if (std::optional<Texture> texture = decode(settings.eight_bit, room_)) {
            found->second = std::uint32_t(scene_.textures.size());
            keep(*std::move(texture), settings);
        }
        return found->second;
    }

private:
    void keep(Texture texture, const TextureSettings& settings);

    Scene& scene_;
    std::size_t room_ = room_for_textures;
    std::map<std::pair<std::string, TextureSettings>, std::optional<std::uint32_t>> known_;
};

}  // namespace claray
