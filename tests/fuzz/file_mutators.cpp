#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cctype>
#include <cstring>
#include <iterator>
#include <limits>
#include <sstream>

#include "fuzz/corpus.h"
#include "fuzz/mutators.h"

namespace pbrt::fuzz {

namespace {

std::string Noise(size_t size, Dice &dice) {
    std::string bytes(size, '\0');
    for (char &c : bytes) c = char(dice.Next());
    return bytes;
}

/// An extreme number as 1, 2, 4 or 8 bytes in either byte order.
std::string ExtremeWord(Dice &dice) {
    constexpr auto kInf = std::numeric_limits<double>::infinity(), kNan = std::numeric_limits<double>::quiet_NaN();
    static const std::vector<std::string> kIntegers = WordsOf(
        "0 1 2 0x7f 0x80 0xff 0x7fff 0xffff 0x10000 0x7fffffff 0x80000000 0xffffffff 0x7fffffffffffffff "
        "0xffffffffffffffff");
    static constexpr double kFloats[] = {0, -0., -1, 1e-40, 1e38, -3e38, kInf, -kInf, kNan},
                            kDoubles[] = {0, -1, 1e300, 1e-300, kInf, kNan};
    const auto bytes = [](auto value) { return std::string(reinterpret_cast<const char *>(&value), sizeof(value)); };
    const size_t size = size_t(1) << dice.Below(4);
    std::string word;
    switch (dice.Below(5)) {
        case 0: word = bytes(std::stoull(dice.Pick(kIntegers), nullptr, 0)).substr(0, size); break;
        case 1: word = bytes(uint64_t(1) << dice.Below(64)).substr(0, size); break;
        case 2: word = bytes(float(dice.Pick(kFloats))); break;
        case 3: word = bytes(dice.Pick(kDoubles)); break;
        default: word = bytes(dice.Next()).substr(0, size);
    }
    if (dice.OneIn(3)) std::reverse(word.begin(), word.end());
    return word;
}

/// Drops, repeats, swaps or joins lines of [begin, end).
void MutateLines(std::string &text, size_t begin, size_t end, Dice &dice) {
    std::vector<size_t> starts = {begin};
    for (size_t i = begin; i + 1 < end; ++i)
        if (text[i] == '\n') starts.push_back(i + 1);
    starts.push_back(end);
    const size_t count = starts.size() - 1, a = dice.Below(count), b = dice.Below(count);
    auto line = [&](size_t i) { return text.substr(starts[i], starts[i + 1] - starts[i]); };
    const std::string one = line(a), other = line(b);
    switch (dice.Below(5)) {
        case 0: text.erase(starts[a], one.size()); break;
        case 1: text.insert(starts[b], one); break;
        case 2:
            if (a < b) {
                text.replace(starts[b], other.size(), one);
                text.replace(starts[a], one.size(), other);
            }
            break;
        case 3: {
            std::string many;
            for (size_t n = 1 + dice.Below(200); n > 0; --n) many += one;
            text.insert(starts[a], many);
            break;
        }
        default:
            if (!one.empty()) text.replace(starts[a] + one.size() - 1, 1, " ");
    }
}

/// Changes bytes, numbers or lines: for files that are included.
void MutateInclude(std::string &text, Dice &dice) {
    switch (dice.Below(3)) {
        case 0: MutateBytes(text, text.size(), dice); break;
        case 1: MutateNumberInText(text, 0, text.size(), dice); break;
        default: MutateLines(text, 0, text.size(), dice);
    }
}

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
        for (size_t i = 0; i < 4; ++i) v = v << 8 | uint8_t(s[at + i]);
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
        case 0: chunks.erase(chunks.begin() + i); break;
        case 1: chunks.insert(chunks.begin() + dice.Below(chunks.size()), Chunk(chunks[i])); break;
        case 2: {
            static const std::vector<std::string> kTypes =
                WordsOf("PLTE tRNS gAMA cHRM iCCP sBIT bKGD pHYs tIME sRGB IDAT zTXt");
            const std::string data = Noise(dice.Below(40), dice);
            chunks.insert(chunks.begin() + std::min<size_t>(1, i), {dice.Pick(kTypes), data});
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
        for (int shift = 24; shift >= 0; shift -= 8) out += char(v >> shift);
    };
    std::string out = bytes.substr(0, 8);
    for (const Chunk &c : chunks) {
        put(out, uint32_t(c.data.size()));
        const std::string body = c.type + c.data;
        out += body;
        put(out, uint32_t(crc32(0, reinterpret_cast<const Bytef *>(body.data()), uInt(body.size()))));
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

std::vector<std::string> WordsOf(const std::string &text) {
    std::istringstream in(text);
    return {std::istream_iterator<std::string>(in), {}};
}

std::string ExtremeNumber(Dice &dice) {
    static const std::vector<std::string> kNumbers = WordsOf(
        "0 -0 -1 1 2 3 1e-40 -1e-40 1e-37 1e-20 1e-10 1e10 1e19 1e20 1e38 -1e38 3e38 3.5e38 1e39 1e400 -1e400 "
        "1e-400 nan inf -inf 2147483647 2147483648 -2147483648 -2147483649 4294967295 4294967296 "
        "9223372036854775807 18446744073709551616 1099511627776 65535 65536 100000 1000000 0.5 .99999999 "
        "1.0000001 0x10 1e 1e+ --1 1.2.3 1,5 07 +5 . - 90 180 360 1e5 -1e5 16777217");
    if (dice.OneIn(30)) return std::string(1 + dice.Below(5000), char('0' + dice.Below(10)));
    return dice.Pick(kNumbers);
}

void MutateBytes(std::string &bytes, size_t head, Dice &dice) {
    const size_t limit = dice.OneIn(2) ? std::min(head, bytes.size()) : bytes.size();
    const size_t at = dice.Below(limit);
    const size_t length = std::min(bytes.size() - at, 1 + dice.Below(dice.OneIn(4) ? 300 : 8));
    switch (dice.Below(9)) {
        case 0:
        case 1:
            if (!bytes.empty()) bytes[at] = char(bytes[at] ^ (1 << dice.Below(8)));
            break;
        case 2:
            if (!bytes.empty()) bytes[at] = char(dice.Next());
            break;
        case 3: {
            const std::string word = ExtremeWord(dice);
            bytes.replace(at, std::min(word.size(), bytes.size() - at), word);
            break;
        }
        case 4: bytes.insert(at, ExtremeWord(dice)); break;
        case 5: bytes.erase(at, length); break;
        case 6: bytes.resize(at); break;
        case 7: bytes.insert(dice.Below(bytes.size() + 1), bytes.substr(at, length)); break;
        default: bytes.replace(at, length, Noise(length, dice));
    }
}

bool MutateNumberInText(std::string &text, size_t begin, size_t end, Dice &dice) {
    std::vector<std::pair<size_t, size_t>> numbers;
    auto begins = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) || c == '.' || c == '-'; };
    for (size_t i = begin; i < end; ++i) {
        if (!begins(text[i])) continue;
        const size_t start = i;
        while (i < end && (begins(text[i]) || text[i] == 'e')) ++i;
        numbers.emplace_back(start, i - start);
    }
    if (numbers.empty()) return false;
    const auto [at, length] = dice.Pick(numbers);
    std::string number = text.substr(at, length);
    switch (dice.Below(6)) {
        case 0: number = fmt::format("-{}", number); break;
        case 1: number += char('0' + dice.Below(10)); break;
        case 2: number += fmt::format("e{}", int(dice.Below(80)) - 40); break;
        default: number = ExtremeNumber(dice);
    }
    text.replace(at, length, number);
    return true;
}

std::string AssetKind(const CaseFile &asset) {
    const std::string &name = asset.name;
    if (name.ends_with(".ply")) return asset.bytes.find("format ascii") < 40 ? "ply-ascii" : "ply-binary";
    for (const auto &[end, kind] : {std::pair(".ply.gz", "ply-gz"),
                                    {".pbrt.gz", "include-gz"},
                                    {".pbrt", "include"},
                                    {".dat", "lens"},
                                    {".spd", "spectrum"}})
        if (name.ends_with(end)) return kind;
    const size_t dot = name.rfind('.');
    return dot == std::string::npos ? "other" : name.substr(dot + 1);
}

void MutateAsset(CaseFile &asset, Dice &dice) {
    const std::string kind = AssetKind(asset);
    std::string &bytes = asset.bytes;
    if (kind.ends_with("-gz")) return MutateGzip(asset, dice);
    if (dice.OneIn(200)) return bytes.clear();
    if (kind.starts_with("ply")) return MutatePly(bytes, dice);
    if (kind == "include") return MutateInclude(bytes, dice);
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
