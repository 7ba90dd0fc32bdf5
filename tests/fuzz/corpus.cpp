#include "fuzz/corpus.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfTiledOutputFile.h>
#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <stdexcept>

namespace pbrt::fuzz {

namespace {

namespace fs = std::filesystem;

constexpr int kSize = 8;

/// Values in (0, 1] that differ from pixel to pixel.
float Value(int x, int y, int c) { return float((x * 37 + y * 101 + c * 53) % 97 + 3) / 100; }

Image Picture(PixelFormat format, const std::vector<std::string> &channels, int width = kSize) {
    Image image(format, {width, kSize}, channels);
    ForEachValue(image, [&](Point2i p, int c) { image.Set(p, c, Value(p.x, p.y, c)); });
    return image;
}

std::string Written(const std::string &folder, const std::string &extension, const Image &image) {
    const std::string path = folder + "/asset." + extension;
    WriteImage(path, image);
    return TakeFile(path);
}

/// EXR files of other layouts than our own writer's.
std::string OtherExr(const std::string &folder, Imf::Compression compression, bool tiled, Imf::PixelType type) {
    const std::string path = folder + "/asset.exr";
    Image image = Picture(type == Imf::HALF ? PixelFormat::Half : PixelFormat::Float, {"R", "G", "B"});
    Imf::Header header(kSize, kSize);
    header.compression() = compression;
    Imf::FrameBuffer buffer;
    const size_t bytes = image.Bytes() / image.ValueCount();
    for (int c = 0; c < 3; ++c) {
        const std::string name(1, "RGB"[c]);
        header.channels().insert(name, Imf::Channel(type));
        char *first = static_cast<char *>(image.Data()) + c * bytes;
        buffer.insert(name, Imf::Slice(type, first, 3 * bytes, 3 * bytes * kSize));
    }
    if (tiled) {
        header.setTileDescription(Imf::TileDescription(4, 4));
        Imf::TiledOutputFile file(path.c_str(), header);
        file.setFrameBuffer(buffer);
        file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
    } else {
        Imf::OutputFile file(path.c_str(), header);
        file.setFrameBuffer(buffer);
        file.writePixels(kSize);
    }
    return TakeFile(path);
}

std::string RadianceHdr() {
    std::string out = fmt::format("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {0} +X {0}\n", kSize);
    for (int y = 0; y < kSize; ++y)
        for (int x = 0; x < kSize; ++x) {
            for (int c = 0; c < 3; ++c) out += char(128 + int(Value(x, y, c) * 100));
            out += char(128);
        }
    return out;
}

std::string Targa(bool runLength) {
    std::string out(18, '\0');
    out[2] = runLength ? 10 : 2;
    out[12] = out[14] = kSize;
    out[16] = 24;
    for (int y = 0; y < kSize; ++y) {
        if (runLength) out += char(kSize - 1);  // a packet of single pixels
        for (int x = 0; x < kSize; ++x)
            for (int c = 0; c < 3; ++c) out += char(int(Value(x, y, c) * 255));
    }
    return out;
}

/// A sheet of 3 x 3 vertices with two quads, three triangles and a face of five corners.
enum class PlyKind { Ascii, Little, Big };
std::string Ply(PlyKind kind) {
    constexpr const char *kFormats[] = {"ascii", "binary_little_endian", "binary_big_endian"};
    std::string out =
        fmt::format("ply\nformat {} 1.0\ncomment made for tests\nelement vertex 9\n", kFormats[int(kind)]);
    for (const char *name : {"x", "y", "z", "nx", "ny", "nz"}) out += fmt::format("property float {}\n", name);
    out += "property double u\nproperty double v\nproperty uchar red\n";
    out += "element face 6\nproperty list uchar int vertex_indices\nproperty int face_indices\nend_header\n";
    auto put = [&](auto value) {
        if (kind == PlyKind::Ascii) {
            out += fmt::format("{} ", value);
            return;
        }
        std::array<char, sizeof(value)> raw{};
        std::memcpy(raw.data(), &value, sizeof(value));
        if (kind == PlyKind::Big) std::reverse(raw.begin(), raw.end());
        out.append(raw.data(), raw.size());
    };
    auto line = [&] {
        if (kind == PlyKind::Ascii) out += '\n';
    };
    for (int y = 0; y < 3; ++y)
        for (int x = 0; x < 3; ++x) {
            for (double v : {x / 2., y / 2., 0.1 * (x * y), 0., 0., -1.}) put(float(v));
            put(x / 2.);
            put(y / 2.);
            put(uint8_t(200));
            line();
        }
    const std::vector<std::vector<int>> faces = {{0, 1, 4, 3}, {1, 2, 5, 4}, {3, 4, 6},
                                                 {4, 7, 6},    {4, 5, 7},    {4, 5, 8, 7, 6}};
    for (size_t f = 0; f < faces.size(); ++f) {
        put(uint8_t(faces[f].size()));
        for (int v : faces[f]) put(int32_t(v));
        put(int32_t(f));
        line();
    }
    return out;
}

/// Tables of a measured BSDF, as small as the reader takes them.
std::string MeasuredBsdf() {
    struct Field {
        std::string name;
        std::vector<uint64_t> shape;
        std::vector<float> values;
    };
    auto table = [](const char *name, std::vector<uint64_t> shape) {
        Field f{name, shape, {}};
        uint64_t size = 1;
        for (uint64_t n : shape) size *= n;
        for (uint64_t i = 0; i < size; ++i) f.values.push_back(0.2f + Value(int(i), 1, 2));
        return f;
    };
    const std::vector<Field> fields = {{"phi_i", {1}, {0}},
                                       {"theta_i", {3}, {0, 0.7f, 1.5f}},
                                       {"wavelengths", {3}, {360, 500, 830}},
                                       table("ndf", {2, 4}),
                                       table("sigma", {2, 4}),
                                       table("vndf", {1, 3, 4, 4}),
                                       table("luminance", {1, 3, 4, 4}),
                                       table("spectra", {1, 3, 3, 4, 4})};
    auto put = [](std::string &out, auto v) { out.append(reinterpret_cast<const char *>(&v), sizeof(v)); };
    size_t head = 18;
    for (const Field &f : fields) head += 2 + f.name.size() + 2 + 1 + 8 + 8 * f.shape.size();
    std::string out("tensor_file\0\1\0", 14), body;
    put(out, uint32_t(fields.size()));
    for (const Field &f : fields) {
        put(out, uint16_t(f.name.size()));
        out += f.name;
        put(out, uint16_t(f.shape.size()));
        put(out, uint8_t(10));
        put(out, uint64_t(head + body.size()));
        for (uint64_t n : f.shape) put(out, n);
        for (float v : f.values) put(body, v);
    }
    return out + body;
}

/// What all of `bytes` becomes in a stream of zlib, up to `most` bytes; `run`: deflate or inflate.
std::string Flow(z_stream &stream, const std::string &bytes, size_t most, int (*run)(z_stream *, int)) {
    std::string out(most, '\0');
    stream.next_in = reinterpret_cast<Bytef *>(const_cast<char *>(bytes.data()));
    stream.avail_in = uInt(bytes.size());
    stream.next_out = reinterpret_cast<Bytef *>(out.data());
    stream.avail_out = uInt(out.size());
    run(&stream, Z_FINISH);
    out.resize(stream.total_out);
    return out;
}

constexpr size_t kMaxAssetBytes = 20000;

std::vector<fs::path> FilesBelow(const fs::path &folder) {
    std::vector<fs::path> files;
    for (const auto &entry : fs::recursive_directory_iterator(folder))
        if (entry.is_regular_file()) files.push_back(entry.path());
    std::sort(files.begin(), files.end());  // the order of a folder differs from machine to machine
    return files;
}

std::vector<std::string> AssetsNamedIn(const std::string &text) {
    static const std::regex kAsset(R"re("\.\./assets/([^"]+)")re");
    std::set<std::string> names;
    for (std::sregex_iterator i(text.begin(), text.end(), kAsset), end; i != end; ++i) names.insert((*i)[1]);
    return {names.begin(), names.end()};
}

}  // namespace

std::string BytesOf(const fs::path &path) {
    std::ostringstream bytes;
    bytes << std::ifstream(path, std::ios::binary).rdbuf();
    return bytes.str();
}

std::string TakeFile(const fs::path &path) {
    const std::string bytes = BytesOf(path);
    fs::remove(path);
    return bytes;
}

std::string Compress(const std::string &bytes) {
    z_stream stream{};
    deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY);
    std::string out = Flow(stream, bytes, deflateBound(&stream, bytes.size()) + 32, deflate);
    deflateEnd(&stream);
    return out;
}

std::string Uncompress(const std::string &bytes) {
    z_stream stream{};
    inflateInit2(&stream, 15 + 16);
    std::string out = Flow(stream, bytes, 1 << 20, inflate);
    inflateEnd(&stream);
    return out;
}

std::vector<CaseFile> MakeAssets(const std::string &folder) {
    const std::vector<std::string> rgb = {"R", "G", "B"};
    return {
        {"ascii.ply", Ply(PlyKind::Ascii)},
        {"little.ply", Ply(PlyKind::Little)},
        {"big.ply", Ply(PlyKind::Big)},
        {"ascii.ply.gz", Compress(Ply(PlyKind::Ascii))},
        {"little.ply.gz", Compress(Ply(PlyKind::Little))},
        {"half.exr", Written(folder, "exr", Picture(PixelFormat::Half, rgb))},
        {"float.exr", Written(folder, "exr", Picture(PixelFormat::Float, {"R", "G", "B", "A"}))},
        {"gray.exr", Written(folder, "exr", Picture(PixelFormat::Float, {"Y"}))},
        {"tiled.exr", OtherExr(folder, Imf::PIZ_COMPRESSION, true, Imf::HALF)},
        {"rle.exr", OtherExr(folder, Imf::RLE_COMPRESSION, false, Imf::HALF)},
        {"plain.exr", OtherExr(folder, Imf::NO_COMPRESSION, false, Imf::FLOAT)},
        {"b44.exr", OtherExr(folder, Imf::B44_COMPRESSION, false, Imf::HALF)},
        {"dwaa.exr", OtherExr(folder, Imf::DWAA_COMPRESSION, false, Imf::HALF)},
        {"pxr24.exr", OtherExr(folder, Imf::PXR24_COMPRESSION, true, Imf::FLOAT)},
        {"rgb.png", Written(folder, "png", Picture(PixelFormat::U8, rgb))},
        {"rgba.png", Written(folder, "png", Picture(PixelFormat::U8, {"R", "G", "B", "A"}))},
        {"gray.png", Written(folder, "png", Picture(PixelFormat::U8, {"Y"}, 5))},
        {"rgb.pfm", Written(folder, "pfm", Picture(PixelFormat::Float, rgb))},
        {"gray.pfm", Written(folder, "pfm", Picture(PixelFormat::Float, {"Y"}))},
        {"rgb.hdr", RadianceHdr()},
        {"plain.tga", Targa(false)},
        {"packed.tga", Targa(true)},
        {"tables.bsdf", MeasuredBsdf()},
        {"lens.dat",
         "# radius thickness index diameter (mm)\n22 4 1.6 20\n-40 3 1 20\n0 3 0 12\n40 4 1.6 20\n-22 30 1 20\n"},
        {"curve.spd", "# nm value\n380 0.2\n450.5 0.4\n550 0.7\n650 3e-1\n760 .1\n"},
        {"part.pbrt", "Material \"diffuse\" \"rgb reflectance\" [ .2 .4 .3 ]\nShape \"sphere\" \"float radius\" .4\n"},
        {"part.pbrt.gz",
         Compress("AttributeBegin\n  Translate 0 .1 .2\n  Shape \"disk\" \"float radius\" .3\nAttributeEnd\n")}};
}

Corpus Corpus::Load(const std::string &assetFolder) {
    Corpus corpus;
    const fs::path suite = PBRT_SOURCE_DIR "/tests/conformance/suite/scenes";
    corpus.assets = MakeAssets(assetFolder);
    for (const fs::path &path : FilesBelow(suite / "assets"))
        if (fs::file_size(path) < kMaxAssetBytes)
            corpus.assets.push_back({path.lexically_relative(suite / "assets").string(), BytesOf(path)});
    for (const CaseFile &asset : corpus.assets) {
        const fs::path path = fs::path(assetFolder) / asset.name;
        fs::create_directories(path.parent_path());
        std::ofstream(path, std::ios::binary) << asset.bytes;
    }

    corpus.states = MakeStateSeeds(fs::path(assetFolder).parent_path().string());

    std::set<std::string> notSupported;
    std::ifstream list(PBRT_SOURCE_DIR "/tests/conformance/not_supported.txt");
    for (std::string name; list >> name;) notSupported.insert(name);

    auto add = [&](const fs::path &path, const std::string &name) {
        static const std::regex kResolution(R"re("integer ([xy])resolution" \[ \d+ \])re");
        SeedScene scene{name, BytesOf(path), {}, !name.starts_with("errors/") && !notSupported.contains(name)};
        if (scene.text.find("pixelbounds") == std::string::npos)
            scene.text = std::regex_replace(scene.text, kResolution, "\"integer $1resolution\" [ 12 ]");
        scene.assets = AssetsNamedIn(scene.text);
        // Assets too big for many runs are left out, and with them their scenes.
        for (const std::string &asset : scene.assets)
            if (!corpus.Asset(asset)) return;
        corpus.scenes.push_back(std::move(scene));
    };
    for (const fs::path &path : FilesBelow(PBRT_SOURCE_DIR "/tests/fuzz/seeds")) add(path, path.stem().string());
    for (const fs::path &path : FilesBelow(suite))
        if (path.extension() == ".pbrt" && path.parent_path().parent_path() == suite &&
            path.parent_path().filename() != "assets" && fs::file_size(path) < kMaxAssetBytes)
            add(path, path.lexically_relative(suite).replace_extension().string());
    if (corpus.scenes.size() < 20) throw std::runtime_error("the seed scenes are missing");
    return corpus;
}

const CaseFile *Corpus::Asset(const std::string &name) const {
    for (const CaseFile &asset : assets)
        if (asset.name == name) return &asset;
    return nullptr;
}

}  // namespace pbrt::fuzz
