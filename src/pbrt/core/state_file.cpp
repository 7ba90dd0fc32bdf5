#include "pbrt/core/state_file.h"

#include <zlib.h>

#include <array>
#include <cstdio>

#include "pbrt/core/files.h"

namespace pbrt {
namespace {

constexpr std::array<char, 8> kMagic = {'p', 'b', 'r', 't', 's', 't', 'a', 't'};
/// Incremented with every change of the layout of the file or its content.
constexpr uint32_t kVersion = 6;
constexpr size_t kSumBytes = sizeof(uint64_t), kHeadBytes = sizeof(kMagic) + sizeof(kVersion) + sizeof(uint64_t);

uint64_t Checksum(std::string_view bytes, uint64_t before = 0) {
    return crc32_z(before, reinterpret_cast<const Bytef *>(bytes.data()), bytes.size());
}

/// Unlike ReadFileContents, does not decompress.
std::string ReadBytes(const std::string &path, const std::string &kind) {
    std::error_code code;
    if (!std::filesystem::is_regular_file(path, code)) throw UserError("{}: there is no such {}.", path, kind);
    const std::unique_ptr<std::FILE, int (*)(std::FILE *)> file(std::fopen(path.c_str(), "rb"), std::fclose);
    if (!file) throw UserError("{}: cannot be read.", path);
    std::string content(std::filesystem::file_size(path, code), 0);
    content.resize(std::fread(content.data(), 1, content.size(), file.get()));
    return content;
}

}  // namespace

StateFile::StateFile(const std::string &path, const std::string &kind) : path_(path), content_(ReadBytes(path, kind)) {
    auto fail = [&](const std::string &why) { throw UserError("{}: {}.", path, why); };
    const size_t size = content_.size();
    const std::string_view all(content_);
    if (all.substr(0, sizeof(kMagic)) != std::string_view(kMagic.data(), kMagic.size()))
        fail(size == 0 ? fmt::format("is empty, not a {}", kind) : fmt::format("is not a {}", kind));
    if (size < kHeadBytes + kSumBytes) fail(fmt::format("this {} is cut off", kind));
    const std::string_view summed = all.substr(0, size - kSumBytes);
    StateReader reader(summed.substr(sizeof(kMagic)), path), end(all.substr(summed.size()), path);
    const auto version = reader.Value<uint32_t>();
    const auto length = reader.Value<uint64_t>();
    if (version != kVersion)
        fail(fmt::format("this {} has layout {}; this program reads layout {}", kind, version, kVersion));
    if (length > size) fail(fmt::format("this {} is cut off: it has {} of {} bytes", kind, size, length));
    if (length != size || end.Value<uint64_t>() != Checksum(summed))
        fail(fmt::format("this {} is damaged: its checksum does not fit", kind));
    if (const std::string is = reader.Text(); is != kind) fail(fmt::format("is a {}, not a {}", is, kind));
    for (auto count = reader.Value<uint32_t>(); count > 0; --count) {
        const std::string name = reader.Text();
        const bool isNew = sections_.emplace(name, reader.Take(reader.Value<uint64_t>())).second;
        reader.Require(isNew, "it has a section twice");
    }
    reader.RequireEnd();
}

void WriteStateFile(const std::string &path, const std::string &kind,
                    const std::map<std::string, const StateWriter *> &sections) {
    StateWriter all;
    uint64_t length = kHeadBytes + sizeof(uint64_t) + kind.size() + sizeof(uint32_t) + kSumBytes;
    for (const auto &[name, content] : sections) length += 2 * sizeof(uint64_t) + name.size() + content->Bytes();
    all(kMagic, kVersion, length, kind, uint32_t(sections.size()));
    for (const auto &[name, content] : sections) {
        all(name, content->Bytes());
        for (const std::string_view piece : content->Pieces()) all.Refer(piece.data(), piece.size());
    }
    uint64_t sum = 0;
    for (const std::string_view piece : all.Pieces()) sum = Checksum(piece, sum);
    all.Value(sum);
    PBRT_CHECK(all.Bytes() == length);
    WriteFile(path, all.Pieces());
}

}  // namespace pbrt
