#include "host/io/image/exr.hpp"

#include "claray/error.hpp"

#if CLARAY_WITH_EXR
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfChromaticitiesAttribute.h>
#include <OpenEXR/ImfEnvmap.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfRgbaFile.h>
#include <OpenEXR/ImfRgbaYca.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <tuple>

#include "host/io/image/formats/primaries.hpp"
#endif

namespace claray {

bool is_exr(std::string_view bytes) { return bytes.substr(0, 4) == "\x76\x2f\x31\x01"; }

#if !CLARAY_WITH_EXR

namespace {
constexpr const char* missing = "claray was built without OpenEXR";
}
std::string read_exr_shape(std::string_view, ExrShape&) { return missing; }
std::string read_exr_pixels(std::string_view, const ExrShape&, std::vector<float>&) { return missing; }
bool is_exr_cube(std::string_view) { return false; }
std::vector<Texture> faces_of_exr_cube(const Texture&) { return {}; }
void require_exr(const std::string& path) {
    throw Error(ErrorKind::usage, "cannot write '" + path + "': " + missing,
                "build it with libopenexr-dev, or use .hdr or .pfm");
}
std::string encode_exr(unsigned, unsigned, const std::vector<ImageLayer>&, const ImageAttributes&) {
    require_exr("an EXR");
    return {};
}

#else

namespace {

class MemoryInput : public Imf::IStream {
public:
    explicit MemoryInput(std::string_view bytes) : IStream("memory"), bytes_(bytes) {}
    bool read(char to[], int count) override {
        if (count < 0 || std::uint64_t(count) > bytes_.size() - at_) throw std::runtime_error("it is cut off");
        std::memcpy(to, bytes_.data() + at_, std::size_t(count));
        at_ += std::uint64_t(count);
        return at_ < bytes_.size();
    }
    std::uint64_t tellg() override { return at_; }
    void seekg(std::uint64_t at) override {
        if (at > bytes_.size()) throw std::runtime_error("it is cut off");
        at_ = at;
    }

private:
    std::string_view bytes_;
    std::uint64_t at_ = 0;
};

class MemoryOutput : public Imf::OStream {
public:
    MemoryOutput() : OStream("memory") {}
    void write(const char from[], int count) override {
        const std::size_t end = at_ + std::size_t(count);
        if (end > bytes.size()) bytes.resize(end);
        std::memcpy(bytes.data() + at_, from, std::size_t(count));
        at_ = end;
    }
    std::uint64_t tellp() override { return at_; }
    void seekp(std::uint64_t at) override { at_ = at; }

    std::string bytes;

private:
    std::uint64_t at_ = 0;
};

/// Calls `read`; returns what it throws as text.
template <class Read>
std::string fault_of(const Read& read) {
    try {
        read();
        return {};
    } catch (const std::exception& error) {
        std::string text = error.what();
        std::replace(text.begin(), text.end(), '\n', ' ');
        if (const std::size_t name = text.rfind("\"memory\". "); name != std::string::npos) text.erase(0, name + 10);
        return text.empty() ? "the image is damaged" : text;
    }
}

/// Luminance and chroma: "RY" is (R - Y) / Y, and "BY" is (B - Y) / Y.
bool has_chroma(const Imf::ChannelList& channels) {
    return channels.findChannel("Y") && channels.findChannel("RY") && channels.findChannel("BY") &&
           !channels.findChannel("R");
}

/// The colours of the file itself, else those of its first layer that has some; else luminance, or the only channel.
std::vector<std::string> colors_of(const Imf::ChannelList& channels) {
    const auto with_alpha = [&](const std::string& prefix, std::vector<std::string> names) {
        if (channels.findChannel(prefix + "A") != nullptr) names.push_back(prefix + "A");
        return names;
    };
    const auto in_layer = [&](const std::string& prefix) -> std::vector<std::string> {
        for (const char* name : {"R", "G", "B"})
            if (channels.findChannel(prefix + name) == nullptr) return {};
        return with_alpha(prefix, {prefix + "R", prefix + "G", prefix + "B"});
    };
    if (has_chroma(channels)) return with_alpha("", {"R", "G", "B"});
    if (auto names = in_layer(""); !names.empty()) return names;
    for (auto channel = channels.begin(); channel != channels.end(); ++channel) {
        const std::string name = channel.name();
        if (name.size() > 2 && name.ends_with(".R"))
            if (auto names = in_layer(name.substr(0, name.size() - 1)); !names.empty()) return names;
    }
    if (channels.findChannel("Y") != nullptr) return with_alpha("", {"Y"});
    auto second = channels.begin();
    if (second == channels.end()) return {};
    if (++second == channels.end()) return {channels.begin().name()};
    return {};
}

std::string names_of(const Imf::ChannelList& channels) {
    std::string names;
    for (auto channel = channels.begin(); channel != channels.end(); ++channel)
        names += (names.empty() ? "" : ", ") + std::string(channel.name());
    return names;
}

bool is_environment(const Imf::Header& header) { return Imf::hasEnvmap(header); }

/// What of the file is the image: all that is stored of an environment, else what is to be displayed.
const Imath::Box2i& image_window(const Imf::Header& header) {
    return is_environment(header) ? header.dataWindow() : header.displayWindow();
}

std::pair<unsigned, unsigned> size_of(const Imath::Box2i& window) {
    const std::int64_t width = std::int64_t(window.max.x) - window.min.x + 1;
    const std::int64_t height = std::int64_t(window.max.y) - window.min.y + 1;
    if (width < 1 || height < 1 || width > 1 << 30 || height > 1 << 30) throw std::runtime_error("its size is invalid");
    return {unsigned(width), unsigned(height)};
}

/// The matrix from the file's primaries.
glm::dmat3 to_linear(const Imf::Header& header) {
    if (!Imf::hasChromaticities(header)) return glm::dmat3(1.0);
    const Imf::Chromaticities& c = Imf::chromaticities(header);
    const auto xy = [](const Imath::V2f& v) { return glm::dvec2(v.x, v.y); };
    return to_rec709({xy(c.red), xy(c.green), xy(c.blue), xy(c.white)});
}

/// Chroma with a quarter of the pixels, by OpenEXR's own conversion, in half precision.
void read_sparse_chroma(std::string_view bytes, const ExrShape& shape, std::vector<float>& values) {
    MemoryInput input(bytes);
    Imf::RgbaInputFile file(input);
    const Imath::Box2i& window = file.dataWindow();
    std::vector<Imf::Rgba> pixels(std::size_t(shape.stored_width) * shape.stored_height);
    const std::ptrdiff_t origin = window.min.x + window.min.y * std::ptrdiff_t(shape.stored_width);
    file.setFrameBuffer(pixels.data() - origin, 1, shape.stored_width);
    file.readPixels(window.min.y, window.max.y);
    values.clear();
    for (const Imf::Rgba& pixel : pixels) {
        values.insert(values.end(), {pixel.r, pixel.g, pixel.b});
        if (shape.channels == 4) values.push_back(pixel.a);
    }
}

/// Reads the channels of the data window.
void read_channels(std::string_view bytes, const ExrShape& shape, const std::vector<std::string>& names,
                   std::vector<float>& values) {
    MemoryInput input(bytes);
    Imf::InputFile file(input);
    const Imath::Box2i& window = file.header().dataWindow();
    values.assign(std::size_t(shape.stored_width) * shape.stored_height * shape.channels, 0.f);
    const std::size_t pixel = shape.channels * sizeof(float), row = pixel * shape.stored_width;
    Imf::FrameBuffer buffer;
    for (unsigned c = 0; c < shape.channels; ++c)
        buffer.insert(names[c], Imf::Slice::Make(Imf::FLOAT, values.data() + c, window, pixel, row));
    file.setFrameBuffer(buffer);
    file.readPixels(window.min.y, window.max.y);
}

/// Chroma with as many pixels as luminance.
void read_full_chroma(std::string_view bytes, const ExrShape& shape, const Imf::Header& header,
                      std::vector<float>& values) {
    std::vector<std::string> names = {"RY", "Y", "BY"};
    if (shape.channels == 4) names.emplace_back("A");
    read_channels(bytes, shape, names, values);
    const Imf::Chromaticities primaries =
        Imf::hasChromaticities(header) ? Imf::chromaticities(header) : Imf::Chromaticities();
    const Imath::V3f weights = Imf::RgbaYca::computeYw(primaries);
    for (std::size_t i = 0; i < values.size(); i += shape.channels) {
        const float y = values[i + 1], r = (values[i] + 1) * y, b = (values[i + 2] + 1) * y;
        values[i] = r, values[i + 1] = (y - r * weights.x - b * weights.z) / weights.y, values[i + 2] = b;
    }
}

/// Reads the data window.
void read_stored(std::string_view bytes, const ExrShape& shape, const Imf::Header& header, std::vector<float>& values) {
    if (!has_chroma(header.channels())) return read_channels(bytes, shape, shape.names, values);
    const bool is_full = header.channels()["RY"].xSampling == 1 && header.channels()["RY"].ySampling == 1;
    is_full ? read_full_chroma(bytes, shape, header, values) : read_sparse_chroma(bytes, shape, values);
}

/// What is stored in one window, seen through another: beyond it is black.
std::vector<float> seen_through(const Imath::Box2i& image, const Imath::Box2i& stored, unsigned channels,
                                const std::vector<float>& values) {
    const auto [width, height] = size_of(image);
    const auto [stored_width, stored_height] = size_of(stored);
    std::vector<float> seen(std::size_t(width) * height * channels, 0.f);
    const int left = std::max(image.min.x, stored.min.x), right = std::min(image.max.x, stored.max.x) + 1;
    const int top = std::max(image.min.y, stored.min.y), bottom = std::min(image.max.y, stored.max.y) + 1;
    for (int y = top; y < bottom && left < right; ++y) {
        const std::size_t from = std::size_t(y - stored.min.y) * stored_width + std::size_t(left - stored.min.x);
        const std::size_t to = std::size_t(y - image.min.y) * width + std::size_t(left - image.min.x);
        std::copy_n(&values[from * channels], std::size_t(right - left) * channels, &seen[to * channels]);
    }
    return seen;
}

}  // namespace

std::string read_exr_shape(std::string_view bytes, ExrShape& shape) {
    return fault_of([&] {
        MemoryInput input(bytes);
        const Imf::InputFile file(input);
        std::tie(shape.width, shape.height) = size_of(image_window(file.header()));
        std::tie(shape.stored_width, shape.stored_height) = size_of(file.header().dataWindow());
        const Imf::ChannelList& channels = file.header().channels();
        shape.names = colors_of(channels);
        shape.channels = unsigned(shape.names.size());
        if (shape.names.empty())
            throw std::runtime_error("it has the channels " + names_of(channels) + ", but neither R, G and B nor Y");
        if (has_chroma(channels)) return;
        for (const std::string& name : shape.names)
            if (channels[name].xSampling != 1 || channels[name].ySampling != 1)
                throw std::runtime_error("the channel '" + name + "' is subsampled");
    });
}

std::string read_exr_pixels(std::string_view bytes, const ExrShape& shape, std::vector<float>& values) {
    return fault_of([&] {
        MemoryInput input(bytes);
        const Imf::InputFile file(input);
        const Imf::Header& header = file.header();
        read_stored(bytes, shape, header, values);
        convert_colors(values, shape.channels, to_linear(header));
        if (image_window(header) != header.dataWindow())
            values = seen_through(image_window(header), header.dataWindow(), shape.channels, values);
    });
}

bool is_exr_cube(std::string_view bytes) {
    bool is_cube = false;
    const std::string fault = fault_of([&] {
        MemoryInput input(bytes);
        const Imf::InputFile file(input);
        is_cube = is_environment(file.header()) && Imf::envmap(file.header()) == Imf::ENVMAP_CUBE;
    });
    return fault.empty() && is_cube;
}

namespace {

/// The direction of a point of a face of an Environment (OpenGL specification, table 8.19); x and y are -1 to 1, from
/// the top left.
glm::vec3 direction_on_face(int face, float x, float y) {
    const glm::vec3 directions[] = {{1, -y, -x}, {-1, -y, x}, {x, 1, y}, {x, -1, -y}, {x, -y, 1}, {-x, -y, -1}};
    return directions[face];
}

}  // namespace

std::vector<Texture> faces_of_exr_cube(const Texture& stacked) {
    const unsigned side = stacked.width, n = stacked.channels;
    if (stacked.height != 6 * side)
        throw Error(ErrorKind::user,
                    "'" + stacked.name + "' is a cube map of " + std::to_string(side) + "x" +
                        std::to_string(stacked.height) + " pixels, but its faces are squares one below the other",
                    "export it again");
    const Imath::Box2i window({0, 0}, {int(side) - 1, int(6 * side) - 1});
    std::vector<Texture> faces(6, stacked);
    for (int face = 0; face < 6; ++face) {
        Texture& texture = faces[std::size_t(face)];
        texture.height = side, texture.floats.clear();
        for (unsigned y = 0; y < side; ++y)
            for (unsigned x = 0; x < side; ++x) {
                const auto middle = [&](unsigned i) { return (2 * float(i) + 1) / float(side) - 1; };
                const glm::vec3 d = direction_on_face(face, middle(x), middle(y));
                // The middle of OpenEXR's latitude-longitude images is +z, and that of claray's is -z.
                Imf::CubeMapFace where{};
                Imath::V2f in_face;
                Imf::CubeMap::faceAndPixelPosition({-d.x, d.y, -d.z}, window, where, in_face);
                const Imath::V2f at = Imf::CubeMap::pixelPosition(where, window, in_face);
                const auto nearest = [](float v, unsigned end) {
                    return std::min(std::size_t(std::max(v + 0.5f, 0.f)), std::size_t(end) - 1);
                };
                const std::size_t texel = nearest(at.y, 6 * side) * side + nearest(at.x, side);
                const float* const values = &stacked.floats[texel * n];
                texture.floats.insert(texture.floats.end(), values, values + n);
            }
    }
    return faces;
}

void require_exr(const std::string&) {}

std::string encode_exr(unsigned width, unsigned height, const std::vector<ImageLayer>& layers,
                       const ImageAttributes& attributes) {
    Imf::Header header{int(width), int(height)};
    header.compression() = Imf::ZIP_COMPRESSION;
    for (const auto& [name, text] : attributes) header.insert(name, Imf::StringAttribute(text));
    Imf::FrameBuffer buffer;
    for (const ImageLayer& layer : layers) {
        const std::size_t count = layer.channels.size();
        const Imf::PixelType type = layer.numbers.empty() ? Imf::FLOAT : Imf::UINT;
        const char* data = type == Imf::FLOAT ? reinterpret_cast<const char*>(layer.values.data())
                                              : reinterpret_cast<const char*>(layer.numbers.data());
        for (std::size_t c = 0; c < count; ++c) {
            const std::string name = (layer.name.empty() ? "" : layer.name + ".") + layer.channels[c];
            header.channels().insert(name, Imf::Channel(type));
            buffer.insert(name, Imf::Slice(type, const_cast<char*>(data) + 4 * c, 4 * count, 4 * count * width));
        }
    }
    MemoryOutput output;
    {
        Imf::OutputFile file(output, header);
        file.setFrameBuffer(buffer);
        file.writePixels(int(height));
    }  // which writes the table of lines
    return std::move(output.bytes);
}

#endif

}  // namespace claray
