#include "pbrt/scenefile/unicode.h"

#include <algorithm>
#include <map>
#include <utility>

#include "pbrt/scenefile/unicode_tables.h"

namespace pbrt {

namespace {

struct Decoded {
    char32_t value = 0;
    size_t length = 0;  ///< 0: invalid
};

Decoded DecodeOne(std::string_view s) {
    auto byte = [&](size_t i) { return static_cast<unsigned char>(s[i]); };
    unsigned lead = byte(0);
    if (lead < 0x80) return {lead, 1};
    size_t length = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
    if (lead < 0xc2 || lead > 0xf4 || s.size() < length) return {};
    char32_t value = lead & (0x7fu >> length);
    for (size_t i = 1; i < length; ++i) {
        if ((byte(i) & 0xc0u) != 0x80u) return {};
        value = (value << 6) | (byte(i) & 0x3fu);
    }
    constexpr char32_t kLeast[] = {0, 0, 0x80, 0x800, 0x10000};
    bool surrogate = value >= 0xd800 && value < 0xe000;
    if (value < kLeast[length] || value > 0x10ffff || surrogate) return {};
    return {value, length};
}

void AppendUtf8(std::string &out, char32_t c) {
    auto put = [&](char32_t byte) { out.push_back(static_cast<char>(byte)); };
    if (c < 0x80) {
        put(c);
    } else if (c < 0x800) {
        put(0xc0 | (c >> 6));
        put(0x80 | (c & 0x3f));
    } else if (c < 0x10000) {
        put(0xe0 | (c >> 12));
        put(0x80 | ((c >> 6) & 0x3f));
        put(0x80 | (c & 0x3f));
    } else {
        put(0xf0 | (c >> 18));
        put(0x80 | ((c >> 12) & 0x3f));
        put(0x80 | ((c >> 6) & 0x3f));
        put(0x80 | (c & 0x3f));
    }
}

int CombiningClass(char32_t c) {
    auto ranges = unicode::CombiningClasses();
    auto after = std::upper_bound(ranges.begin(), ranges.end(), c,
                                  [](char32_t value, const unicode::CombiningRange &r) { return value < r.first; });
    if (after == ranges.begin()) return 0;
    const unicode::CombiningRange &r = *std::prev(after);
    return c <= r.last ? r.combiningClass : 0;
}

// Hangul syllables are composed by arithmetic (Unicode standard, section 3.12).
constexpr char32_t kSyllables = 0xac00, kLeads = 0x1100, kVowels = 0x1161, kTrails = 0x11a7;
constexpr char32_t kLeadCount = 19, kVowelCount = 21, kTrailCount = 28;

void Decompose(char32_t c, std::u32string &out) {
    if (c < 0xc0) {
        out.push_back(c);
        return;
    }
    if (c >= kSyllables && c < kSyllables + kLeadCount * kVowelCount * kTrailCount) {
        char32_t index = c - kSyllables;
        out.push_back(kLeads + index / (kVowelCount * kTrailCount));
        out.push_back(kVowels + index / kTrailCount % kVowelCount);
        if (index % kTrailCount) out.push_back(kTrails + index % kTrailCount);
        return;
    }
    auto pairs = unicode::Pairs();
    auto pair = std::lower_bound(pairs.begin(), pairs.end(), c,
                                 [](const unicode::CanonicalPair &p, char32_t value) { return p.composed < value; });
    if (pair != pairs.end() && pair->composed == c) {
        Decompose(pair->first, out);
        out.push_back(pair->second);
        return;
    }
    auto singles = unicode::Singles();
    auto single =
        std::lower_bound(singles.begin(), singles.end(), c,
                         [](const unicode::CanonicalSingle &s, char32_t value) { return s.composed < value; });
    if (single != singles.end() && single->composed == c)
        Decompose(single->plain, out);
    else
        out.push_back(c);
}

/// The composition of two characters, or 0.
char32_t ComposePair(char32_t first, char32_t second) {
    if (first >= kLeads && first < kLeads + kLeadCount && second >= kVowels && second < kVowels + kVowelCount)
        return kSyllables + ((first - kLeads) * kVowelCount + second - kVowels) * kTrailCount;
    bool openSyllable = first >= kSyllables && first < kSyllables + kLeadCount * kVowelCount * kTrailCount &&
                        (first - kSyllables) % kTrailCount == 0;
    if (openSyllable && second > kTrails && second < kTrails + kTrailCount) return first + second - kTrails;
    static const auto kMade = [] {
        std::map<std::pair<char32_t, char32_t>, char32_t> made;
        for (const unicode::CanonicalPair &p : unicode::Pairs())
            if (p.composes) made[{p.first, p.second}] = p.composed;
        return made;
    }();
    auto found = kMade.find({first, second});
    return found == kMade.end() ? 0 : found->second;
}

void SortMarks(std::u32string &text) {
    for (size_t begin = 0; begin < text.size();) {
        size_t end = begin;
        while (end < text.size() && CombiningClass(text[end]) != 0) ++end;
        std::stable_sort(text.begin() + static_cast<std::ptrdiff_t>(begin),
                         text.begin() + static_cast<std::ptrdiff_t>(end),
                         [](char32_t a, char32_t b) { return CombiningClass(a) < CombiningClass(b); });
        begin = end + 1;
    }
}

std::u32string Recompose(const std::u32string &text) {
    std::u32string out;
    size_t starter = std::u32string::npos;
    int lastClass = 0;  // of the last character kept after the starter
    for (char32_t c : text) {
        int combiningClass = CombiningClass(c);
        if (starter != std::u32string::npos) {
            bool adjacent = starter + 1 == out.size();
            bool blocked = !adjacent && lastClass >= combiningClass;
            char32_t made = blocked ? 0 : ComposePair(out[starter], c);
            if (made) {
                out[starter] = made;
                continue;
            }
        }
        if (combiningClass == 0) starter = out.size();
        lastClass = combiningClass;
        out.push_back(c);
    }
    return out;
}

}  // namespace

std::optional<size_t> FindInvalidUtf8(std::string_view text) {
    for (size_t i = 0; i < text.size();) {
        Decoded d = DecodeOne(text.substr(i));
        if (d.length == 0) return i;
        i += d.length;
    }
    return {};
}

std::string ComposeUtf8(std::string_view text) {
    if (std::all_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 0x80; }))
        return std::string(text);
    std::u32string decomposed;
    for (size_t i = 0; i < text.size();) {
        Decoded d = DecodeOne(text.substr(i));
        if (d.length == 0) return std::string(text);
        Decompose(d.value, decomposed);
        i += d.length;
    }
    SortMarks(decomposed);
    std::string out;
    for (char32_t c : Recompose(decomposed)) AppendUtf8(out, c);
    return out;
}

}  // namespace pbrt
