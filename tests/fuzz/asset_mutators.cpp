#include "fuzz/asset_mutators.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <vector>

#include "fuzz/assets.h"
#include "fuzz/byte_mutators.h"
#include "fuzz/scene_mutators.h"

namespace pbrt::fuzz {

namespace {

/// The offset of the first byte after the header, for formats whose header is text with a known end.
size_t TextHeaderSize(const std::string &bytes, const std::string &endMark) {
    const size_t at = bytes.find(endMark);
    return at == std::string::npos ? std::min<size_t>(bytes.size(), 64) : at + endMark.size();
}

void ReplaceWord(std::string &text, size_t end, const std::vector<std::string> &words, Dice &dice) {
    std::vector<std::pair<size_t, size_t>> found;
    for (const std::string &word : words)
        for (size_t at = text.find(word); at < end; at = text.find(word, at + 1)) found.emplace_back(at, word.size());
    if (found.empty()) return;
    const auto [at, size] = dice.Pick(found);
    text.replace(at, size, dice.Pick(words));
}

void MutatePly(std::string &bytes, Dice &dice) {
    static const std::vector<std::string> kWords = WordsOf(
        "ascii binary_little_endian binary_big_endian char uchar short ushort int uint float double list int8 "
        "float64 vertex face vertex_indices x y z nx u v s red property element 1.0");
    const size_t header = TextHeaderSize(bytes, "end_header\n");
    const bool isText = bytes.find("format ascii") != std::string::npos;
    switch (dice.Below(5)) {
        case 0: MutateNumberInText(bytes, 0, header, dice); break;
        case 1: ReplaceWord(bytes, header, kWords, dice); break;
        case 2: MutateLines(bytes, 0, header, dice); break;
        case 3:
            if (!isText) MutateBytes(bytes, header, dice);
            else if (dice.OneIn(2)) MutateNumberInText(bytes, header, bytes.size(), dice);
            else MutateLines(bytes, header, bytes.size(), dice);
            break;
        default: MutateBytes(bytes, header, dice);
    }
}

/// Overwrites the value, the size, the type or the name of an attribute of the header.
void MutateExrAttribute(std::string &bytes, Dice &dice) {
    struct Attribute {
        size_t name, type, size, value, end;
    };
    std::vector<Attribute> attributes;
    for (size_t at = 8; at < bytes.size() && bytes[at] != 0;) {
        Attribute a{};
        a.name = at;
        a.type = bytes.find('\0', a.name) + 1;
        if (a.type == 0) break;
        a.size = bytes.find('\0', a.type) + 1;
        if (a.size == 0 || a.size + 4 > bytes.size()) break;
        uint32_t size = 0;
        std::memcpy(&size, bytes.data() + a.size, 4);
        a.value = a.size + 4;
        a.end = a.value + size;
        if (a.end > bytes.size()) break;
        attributes.push_back(a);
        at = a.end;
    }
    if (attributes.empty()) return MutateBytes(bytes, 64, dice);
    const Attribute &a = dice.Pick(attributes);
    auto overwrite = [&](size_t at, size_t end) {
        const std::string word = ExtremeWord(dice);
        bytes.replace(at, std::min({word.size(), end - at, bytes.size() - at}), word.substr(0, end - at));
    };
    switch (dice.Below(8)) {
        case 0: overwrite(a.size, a.value); break;
        case 1: bytes.erase(a.name, a.end - a.name); break;
        case 2: bytes.insert(a.name, bytes.substr(a.name, a.end - a.name)); break;
        case 3: {
            const Attribute &b = dice.Pick(attributes);
            bytes.replace(a.type, a.size - a.type, bytes.substr(b.type, b.size - b.type));
            break;
        }
        default:
            if (a.end > a.value) overwrite(a.value + dice.Below(a.end - a.value), a.end);
    }
}

/// Changes chunks and corrects their checksums, so that readers accept the change.
void MutatePngChunk(std::string &bytes, Dice &dice) {
    struct Chunk {
        std::string type, data;
    };
    auto number = [](const std::string &s, size_t at) {
        uint32_t v = 0;
        for (size_t i = 0; i < 4; ++i) v = v << 8 | static_cast<uint8_t>(s[at + i]);
        return v;
    };
    std::vector<Chunk> chunks;
    for (size_t at = 8; at + 12 <= bytes.size();) {
        const size_t length = number(bytes, at);
        if (length > bytes.size() - at - 12) break;
        chunks.push_back({bytes.substr(at + 4, 4), bytes.substr(at + 8, length)});
        at += 12 + length;
    }
    if (chunks.empty()) return MutateBytes(bytes, 64, dice);
    const size_t i = dice.OneIn(2) ? 0 : dice.Below(chunks.size());
    switch (dice.Below(7)) {
        case 0: chunks.erase(chunks.begin() + static_cast<std::ptrdiff_t>(i)); break;
        case 1:
            chunks.insert(chunks.begin() + static_cast<std::ptrdiff_t>(dice.Below(chunks.size())), Chunk(chunks[i]));
            break;
        case 2: {
            static const std::vector<std::string> kTypes =
                WordsOf("PLTE tRNS gAMA cHRM iCCP sBIT bKGD pHYs tIME sRGB IDAT zTXt");
            std::string data(dice.Below(40), '\0');
            for (char &c : data) c = static_cast<char>(dice.Next());
            chunks.insert(chunks.begin() + static_cast<std::ptrdiff_t>(std::min<size_t>(1, i)),
                          {dice.Pick(kTypes), data});
            break;
        }
        default: {
            std::string &data = chunks[i].data;
            if (data.empty()) break;
            const std::string word = ExtremeWord(dice);
            const size_t at = dice.Below(data.size());
            data.replace(at, std::min(word.size(), data.size() - at), word);
        }
    }
    auto put = [](std::string &out, uint32_t v) {
        for (int shift = 24; shift >= 0; shift -= 8) out += static_cast<char>(v >> shift);
    };
    std::string out = bytes.substr(0, 8);
    for (const Chunk &c : chunks) {
        put(out, static_cast<uint32_t>(c.data.size()));
        const std::string body = c.type + c.data;
        out += body;
        put(out, static_cast<uint32_t>(
                     crc32(0, reinterpret_cast<const Bytef *>(body.data()), static_cast<uInt>(body.size()))));
    }
    bytes = std::move(out);
}

void MutateGzip(CaseFile &asset, Dice &dice) {
    CaseFile inner{asset.name.substr(0, asset.name.size() - 3), Uncompress(asset.bytes)};
    switch (dice.Below(8)) {
        case 0: MutateBytes(asset.bytes, 10, dice); break;
        case 1: asset.bytes.resize(dice.Below(asset.bytes.size())); break;
        case 2: asset.bytes += asset.bytes; break;
        case 3: asset.bytes += "what follows the end"; break;
        case 4:
            // Few bytes that decompress to many.
            if (dice.OneIn(100)) asset.bytes = Compress(inner.bytes + std::string(size_t(64) << 20, ' '));
            else asset.bytes = Compress(Compress(inner.bytes));
            break;
        default: MutateAsset(inner, dice); asset.bytes = Compress(inner.bytes);
    }
}

}  // namespace

std::string AssetKind(const CaseFile &asset) {
    auto endsWith = [&](const char *end) { return asset.name.ends_with(end); };
    if (endsWith(".ply.gz")) return "ply-gz";
    if (endsWith(".ply")) return asset.bytes.find("format ascii") < 40 ? "ply-ascii" : "ply-binary";
    if (endsWith(".pbrt.gz")) return "include-gz";
    if (endsWith(".pbrt")) return "include";
    if (endsWith(".dat")) return "lens";
    if (endsWith(".spd")) return "spectrum";
    const size_t dot = asset.name.rfind('.');
    return dot == std::string::npos ? "other" : asset.name.substr(dot + 1);
}

void MutateAsset(CaseFile &asset, Dice &dice) {
    const std::string kind = AssetKind(asset);
    std::string &bytes = asset.bytes;
    if (kind.ends_with("-gz")) return MutateGzip(asset, dice);
    if (dice.OneIn(200)) {
        bytes.clear();
        return;
    }
    if (kind.starts_with("ply")) return MutatePly(bytes, dice);
    if (kind == "include") return MutateSceneText(bytes, dice);
    if (kind == "lens" || kind == "spectrum") {
        if (dice.OneIn(2)) MutateNumberInText(bytes, 0, bytes.size(), dice);
        else if (dice.OneIn(2)) MutateLines(bytes, 0, bytes.size(), dice);
        else MutateBytes(bytes, bytes.size(), dice);
        return;
    }
    if (kind == "exr" && !dice.OneIn(3)) return MutateExrAttribute(bytes, dice);
    if (kind == "png" && !dice.OneIn(3)) return MutatePngChunk(bytes, dice);
    const size_t head = kind == "pfm"   ? TextHeaderSize(bytes, "1.0\n")
                        : kind == "hdr" ? TextHeaderSize(bytes, "+X 8\n")
                        : kind == "tga" ? 18
                                        : 200;
    if ((kind == "pfm" || kind == "hdr") && dice.OneIn(2))
        MutateNumberInText(bytes, 0, std::min(head, bytes.size()), dice);
    else MutateBytes(bytes, head, dice);
}

}  // namespace pbrt::fuzz
