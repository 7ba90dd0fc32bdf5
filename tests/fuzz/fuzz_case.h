#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace pbrt::fuzz {

struct CaseFile {
    std::string name;
    std::string bytes;
};

/// Everything that one run of pbrt or lightlab is given. The scene is the first file; files that are not mutated lie in
/// ../assets.
struct FuzzCase {
    std::string kind;  ///< the kind of mutation
    std::string seed;  ///< the name of the scene that the case was made from
    std::vector<CaseFile> files;
    std::vector<std::string> arguments;  ///< without the program, the scene and --outfile
    std::string output = "out.exr";
    bool mustBeRefused = false;  ///< a render is a failure
    bool isLightlab = false;     ///< the second file is a stored reference, refused if it is rendered again
};

/// Uniform numbers from a seed, the same on every machine.
class Dice {
  public:
    explicit Dice(uint64_t seed) : state_(seed) {}
    uint64_t Next() {
        uint64_t z = (state_ += 0x9e3779b97f4a7c15ull);
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
        return z ^ (z >> 31);
    }
    /// In [0, n); 0 if n is 0.
    size_t Below(size_t n) { return n ? size_t(Next() % n) : 0; }
    /// True once in n times.
    bool OneIn(size_t n) { return Below(n) == 0; }
    template <class Container>
    const auto &Pick(const Container &from) {
        return *(std::begin(from) + std::ptrdiff_t(Below(std::size(from))));
    }

  private:
    uint64_t state_;
};

}  // namespace pbrt::fuzz
