#include "host/io/image/exr.hpp"

#include "claray/error.hpp"

#if CLARAY_WITH_EXR
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>
#endif

namespace claray {

bool is_exr(std::string_view bytes) { return bytes.substr(0, 4) == "\x76\x2f\x31\x01"; }

#if !CLARAY_WITH_EXR

namespace {
constexpr const char* missing = "claray was built without OpenEXR";
}
std::string read_exr_shape(std::string_view, ExrShape&) { return missing; }
std::string read_exr_pixels(std::string_view, const ExrShape&, std::vector<float>&) { return missing; }
void require_exr(const std::string& path) {
    throw Error(ErrorKind::usage, "cannot write '" + path + "': " + missing,
                "build it with libopenexr-dev, or use .hdr or .pfm");
}
std::string encode_exr(unsigned, unsigned, const std::vector<ImageLayer>&) {
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
        return text.empty() ? "the image is damaged" : text;
    }
}

/// The colours of the file itself, else those of its first layer that has some; else luminance.
std::vector<std::string> colors_of(const Imf::ChannelList& channels) {
    const auto in_layer = [&](const std::string& prefix) -> std::vector<std::string> {
        std::vector<std::string> names;
        for (const char* name : {"R", "G", "B"})
            if (channels.findChannel(prefix + name) == nullptr) return {};
        for (const char* name : {"R", "G", "B"}) names.push_back(prefix + name);
        if (channels.findChannel(prefix + "A") != nullptr) names.push_back(prefix + "A");
        return names;
    };
    if (auto names = in_layer(""); !names.empty()) return names;
    for (auto channel = channels.begin(); channel != channels.end(); ++channel) {
        const std::string name = channel.name();
        if (name.size() > 2 && name.ends_with(".R"))
            if (auto names = in_layer(name.substr(0, name.size() - 1)); !names.empty()) return names;
    }
    if (channels.findChannel("Y") != nullptr) return {"Y"};
    return {};
}

}  // namespace

std::string read_exr_shape(std::string_view bytes, ExrShape& shape) {
    return fault_of([&] {
        MemoryInput input(bytes);
        const Imf::InputFile file(input);
        const Imath::Box2i& window = file.header().dataWindow();
        const std::int64_t width = std::int64_t(window.max.x) - window.min.x + 1;
        const std::int64_t height = std::int64_t(window.max.y) - window.min.y + 1;
        if (width < 1 || height < 1 || width > 1 << 30 || height > 1 << 30)
            throw std::runtime_error("its size is invalid");
        shape.width = unsigned(width), shape.height = unsigned(height);
        shape.names = colors_of(file.header().channels());
        shape.channels = unsigned(shape.names.size());
        if (shape.names.empty()) throw std::runtime_error("it has neither the channels R, G and B nor Y");
        for (const std::string& name : shape.names) {
            const Imf::Channel& channel = file.header().channels()[name];
            if (channel.xSampling != 1 || channel.ySampling != 1)
                throw std::runtime_error("the channel '" + name + "' is subsampled");
        }
    });
}

std::string read_exr_pixels(std::string_view bytes, const ExrShape& shape, std::vector<float>& values) {
    return fault_of([&] {
        MemoryInput input(bytes);
        Imf::InputFile file(input);
        const Imath::Box2i& window = file.header().dataWindow();
        values.assign(std::size_t(shape.width) * shape.height * shape.channels, 0.f);
        const std::size_t pixel = shape.channels * sizeof(float), row = pixel * shape.width;
        Imf::FrameBuffer buffer;
        for (unsigned c = 0; c < shape.channels; ++c)
            buffer.insert(shape.names[c], Imf::Slice::Make(Imf::FLOAT, values.data() + c, window, pixel, row));
        file.setFrameBuffer(buffer);
        file.readPixels(window.min.y, window.max.y);
    });
}

void require_exr(const std::string&) {}

std::string encode_exr(unsigned width, unsigned height, const std::vector<ImageLayer>& layers) {
    Imf::Header header{int(width), int(height)};
    header.compression() = Imf::ZIP_COMPRESSION;
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
