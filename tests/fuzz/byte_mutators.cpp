#include "fuzz/byte_mutators.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <iterator>
#include <limits>
#include <sstream>
#include <vector>

namespace pbrt::fuzz {

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
    if (dice.OneIn(30)) return std::string(1 + dice.Below(5000), static_cast<char>('0' + dice.Below(10)));
    return dice.Pick(kNumbers);
}

std::string ExtremeWord(Dice &dice) {
    constexpr auto kInf = std::numeric_limits<double>::infinity(), kNan = std::numeric_limits<double>::quiet_NaN();
    static constexpr uint64_t kIntegers[] = {0,
                                             1,
                                             2,
                                             0x7f,
                                             0x80,
                                             0xff,
                                             0x7fff,
                                             0xffff,
                                             0x10000,
                                             0x7fffffff,
                                             0x80000000,
                                             0xffffffff,
                                             0x7fffffffffffffff,
                                             0xffffffffffffffff};
    static constexpr double kFloats[] = {0, -0., -1, 1e-40, 1e38, -3e38, kInf, -kInf, kNan},
                            kDoubles[] = {0, -1, 1e300, 1e-300, kInf, kNan};
    const auto bytes = [](auto value) { return std::string(reinterpret_cast<const char *>(&value), sizeof(value)); };
    const size_t size = size_t(1) << dice.Below(4);
    std::string word;
    switch (dice.Below(5)) {
        case 0: word = bytes(dice.Pick(kIntegers)).substr(0, size); break;
        case 1: word = bytes(uint64_t(1) << dice.Below(64)).substr(0, size); break;
        case 2: word = bytes(static_cast<float>(dice.Pick(kFloats))); break;
        case 3: word = bytes(dice.Pick(kDoubles)); break;
        default: word = bytes(dice.Next()).substr(0, size);
    }
    if (dice.OneIn(3)) std::reverse(word.begin(), word.end());
    return word;
}

void MutateBytes(std::string &bytes, size_t head, Dice &dice) {
    const size_t limit = dice.OneIn(2) ? std::min(head, bytes.size()) : bytes.size();
    const size_t at = dice.Below(limit);
    const size_t length = std::min(bytes.size() - at, 1 + dice.Below(dice.OneIn(4) ? 300 : 8));
    switch (dice.Below(9)) {
        case 0:
        case 1:
            if (!bytes.empty()) bytes[at] = static_cast<char>(bytes[at] ^ (1 << dice.Below(8)));
            break;
        case 2:
            if (!bytes.empty()) bytes[at] = static_cast<char>(dice.Next());
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
        default: {
            std::string noise(length, '\0');
            for (char &c : noise) c = static_cast<char>(dice.Next());
            bytes.replace(at, length, noise);
        }
    }
}

bool MutateNumberInText(std::string &text, size_t begin, size_t end, Dice &dice) {
    std::vector<std::pair<size_t, size_t>> numbers;
    auto isNumber = [](char c) {
        return std::isdigit(static_cast<unsigned char>(c)) || c == '.' || c == '-' || c == 'e';
    };
    for (size_t i = begin; i < end;) {
        if (!std::isdigit(static_cast<unsigned char>(text[i])) && text[i] != '-' && text[i] != '.') {
            ++i;
            continue;
        }
        size_t stop = i;
        while (stop < end && isNumber(text[stop])) ++stop;
        numbers.emplace_back(i, stop - i);
        i = stop;
    }
    if (numbers.empty()) return false;
    const auto [at, length] = dice.Pick(numbers);
    std::string number = text.substr(at, length);
    switch (dice.Below(6)) {
        case 0: number = fmt::format("-{}", number); break;
        case 1: number += static_cast<char>('0' + dice.Below(10)); break;
        case 2: number += fmt::format("e{}", static_cast<int>(dice.Below(80)) - 40); break;
        default: number = ExtremeNumber(dice);
    }
    text.replace(at, length, number);
    return true;
}

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

}  // namespace pbrt::fuzz
