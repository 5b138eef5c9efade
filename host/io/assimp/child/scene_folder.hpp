// What Assimp may read: the scene's file, and files in its folder and below.
#pragma once

#include <assimp/IOSystem.hpp>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

namespace claray::assimp {

class SceneFolder : public Assimp::IOSystem {
public:
    /// `format`: the extension by which Assimp knows the file, without a dot.
    SceneFolder(const std::filesystem::path& file, const std::string& format);

    /// The name under which Assimp opens the file: it has the extension of the format, whatever the file's own is.
    [[nodiscard]] const std::string& scene() const { return scene_; }

    /// The path of a file that the scene names, relative to its folder. Files of other machines are found by their name
    /// alone, in whatever case, in the folder or the folders in it. Empty: there is none.
    [[nodiscard]] std::optional<std::string> find(const std::string& name) const;

    bool Exists(const char* name) const override { return path_of(name).has_value(); }
    char getOsSeparator() const override { return '/'; }
    Assimp::IOStream* Open(const char* name, const char* mode) override;
    void Close(Assimp::IOStream* stream) override;

private:
    [[nodiscard]] std::optional<std::filesystem::path> path_of(const std::string& name) const;
    void list(const std::filesystem::path& folder, bool also_below);

    std::filesystem::path file_, folder_;
    std::string scene_;
    std::map<std::string, std::string> files_;  ///< by name in lower case, relative to the folder
};

}  // namespace claray::assimp
