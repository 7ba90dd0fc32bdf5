#include "pbrt/math/low_discrepancy.h"

#include "pbrt/core/error.h"

namespace pbrt {

namespace {

constexpr std::array<uint16_t, PrimeCount> FirstPrimes() {
    std::array<uint16_t, PrimeCount> primes{};
    size_t n = 0;
    for (uint16_t candidate = 2; n < primes.size(); ++candidate) {
        bool prime = true;
        for (size_t i = 0; i < n && primes[i] * primes[i] <= candidate && prime; ++i)
            prime = candidate % primes[i] != 0;
        if (prime) primes[n++] = candidate;
    }
    return primes;
}

/// Number of digits in `base` that determine a value within 2^-32.
int DigitsOf(uint32_t base) {
    int digits = 0;
    for (double power = 1; power < 0x1p32; power *= double(base)) ++digits;
    return digits;
}

Float ToUnitInterval(double v) { return std::min(static_cast<Float>(v), OneMinusEpsilon); }

uint32_t PermuteDigit(uint32_t digit, uint32_t base, int position, uint64_t seed) {
    return PermutationElement(digit, base, seed + 0x9e3779b97f4a7c15ull * static_cast<uint64_t>(position));
}

uint32_t AffineDigit(uint32_t digit, uint32_t base, uint32_t multiplier, int position, uint64_t seed) {
    const uint64_t hash = MixBits(seed + 0x9e3779b97f4a7c15ull * static_cast<uint64_t>(position + 1));
    const uint64_t shift = (hash >> 32) * base >> 32;
    return static_cast<uint32_t>((uint64_t(multiplier) * digit + shift) % base);
}

}  // namespace

constinit const std::array<uint16_t, PrimeCount> Primes = FirstPrimes();

Float RadicalInverse(uint32_t base, uint64_t a) {
    double scale = 1 / double(base), weight = scale, value = 0;
    while (a) {
        uint64_t next = a / base;
        value += double(a - next * base) * weight;
        weight *= scale;
        a = next;
    }
    return ToUnitInterval(value);
}

uint64_t InverseRadicalInverse(uint64_t mirrored, uint32_t base, int digits) {
    uint64_t a = 0;
    for (int i = 0; i < digits; ++i) {
        a = a * base + mirrored % base;
        mirrored /= base;
    }
    return a;
}

Float PermutedRadicalInverse(uint32_t base, uint64_t a, uint64_t seed) {
    double scale = 1 / double(base), weight = scale, value = 0;
    int digits = DigitsOf(base);
    for (int k = 0; k < digits; ++k) {
        value += double(PermuteDigit(static_cast<uint32_t>(a % base), base, k, seed)) * weight;
        weight *= scale;
        a /= base;
    }
    return ToUnitInterval(value);
}

Float OwenScrambledRadicalInverse(uint32_t base, uint64_t a, uint64_t seed) {
    double scale = 1 / double(base), weight = scale, value = 0;
    int digits = DigitsOf(base);
    uint64_t node = seed;  // hash of the preceding digits
    for (int k = 0; k < digits; ++k) {
        auto digit = static_cast<uint32_t>(a % base);
        value += double(PermutationElement(digit, base, node)) * weight;
        node = MixBits(node + 0x9e3779b97f4a7c15ull * (digit + 1));
        weight *= scale;
        a /= base;
    }
    return ToUnitInterval(value);
}

Float AffineRadicalInverse(uint32_t base, uint64_t a, uint32_t multiplier, uint64_t seed) {
    double scale = 1 / double(base), weight = scale, value = 0;
    const int digits = DigitsOf(base);
    for (int k = 0; k < digits; ++k) {
        value += double(AffineDigit(static_cast<uint32_t>(a % base), base, multiplier, k, seed)) * weight;
        weight *= scale;
        a /= base;
    }
    return ToUnitInterval(value);
}

DigitPermutations::DigitPermutations(std::span<const uint32_t> multipliers, uint64_t seed) {
    PBRT_CHECK(multipliers.size() <= size_t(PrimeCount));
    for (size_t d = 0; d < multipliers.size(); ++d) {
        Base b;
        b.base = Primes[d];
        PBRT_CHECK(multipliers[d] > 0 && multipliers[d] < b.base);
        b.digits = DigitsOf(b.base);
        b.first = permutations_.size();
        b.firstTail = tails_.size();
        const uint64_t baseSeed = SeedOf(seed, static_cast<int>(d));
        for (int k = 0; k < b.digits; ++k)
            for (uint32_t digit = 0; digit < b.base; ++digit)
                permutations_.push_back(static_cast<uint16_t>(AffineDigit(digit, b.base, multipliers[d], k, baseSeed)));
        tails_.resize(b.firstTail + static_cast<size_t>(b.digits) + 1, 0);
        for (int k = b.digits - 1; k >= 0; --k) {
            size_t at = b.firstTail + static_cast<size_t>(k);
            double zero = permutations_[b.first + static_cast<size_t>(k) * b.base];
            tails_[at] = tails_[at + 1] + zero * std::pow(double(b.base), -(k + 1));
        }
        bases_.push_back(b);
    }
    MakeRows(multipliers);
}

void DigitPermutations::MakeRows(std::span<const uint32_t> multipliers) {
    rows_.length = bases_.size() + Lanes64Count;
    int maxDigits = 0;
    for (const Base &b : bases_) maxDigits = std::max(maxDigits, b.digits);
    rows_.base.assign(rows_.length, 2);
    rows_.inverseBase.assign(rows_.length, 0.5);
    rows_.multiplier.assign(rows_.length, 1);
    rows_.shifts.assign(static_cast<size_t>(maxDigits) * rows_.length, 0);
    rows_.tails.assign(static_cast<size_t>(maxDigits + 1) * rows_.length, 0);
    for (size_t d = 0; d < bases_.size(); ++d) {
        const Base &b = bases_[d];
        rows_.base[d] = b.base;
        rows_.inverseBase[d] = 1 / double(b.base);
        rows_.multiplier[d] = multipliers[d];
        for (size_t k = 0; k < static_cast<size_t>(b.digits); ++k) {
            rows_.shifts[k * rows_.length + d] = permutations_[b.first + k * b.base];
            rows_.tails[k * rows_.length + d] = tails_[b.firstTail + k];
        }
    }
}

void DigitPermutations::RadicalInverses(int firstDimension, uint64_t a, Float values[Lanes64Count]) const {
    const auto d = static_cast<size_t>(firstDimension);
    auto row = [&](const std::vector<double> &rows, size_t k) {
        DoubleLanes v;
        std::memcpy(&v, rows.data() + k * rows_.length + d, sizeof(v));
        return v;
    };
    const DoubleLanes base = row(rows_.base, 0), inverse = row(rows_.inverseBase, 0);
    const DoubleLanes multiplier = row(rows_.multiplier, 0);
    // floor(a / base) for integers below 2^50. Adding one half keeps product rounding from reaching an integer; sums at
    // the size of kRound round to integers.
    constexpr double kRound = 0x1.8p52;
    const DoubleLanes half = 0.5 * inverse - 0.5;
    auto quotient = [&](const DoubleLanes &v) { return ((v * inverse + half) + kRound) - kRound; };
    // The smallest base has the most digits.
    size_t digits = 0;
    for (uint64_t rest = a; rest; rest /= bases_[d].base) ++digits;
    digits = std::min(digits, static_cast<size_t>(bases_[d].digits));

    DoubleLanes left = DoubleLanes{} + static_cast<double>(a), weight = inverse, value{};
    Lanes64 count{};
    for (size_t k = 0; k < digits; ++k) {
        const auto isDigit = left > 0.5;
        const DoubleLanes next = quotient(left), digit = left - next * base;
        const DoubleLanes product = multiplier * digit + row(rows_.shifts, k);
        const DoubleLanes permuted = product - quotient(product) * base;
        value += isDigit ? permuted * weight : DoubleLanes{};
        count -= reinterpret_cast<Lanes64>(isDigit);  // true is all bits set
        weight *= inverse;
        left = next;
    }
    for (size_t lane = 0; lane < Lanes64Count; ++lane)
        values[lane] = ToUnitInterval(value[lane] + rows_.tails[count[lane] * rows_.length + d + lane]);
}

Float DigitPermutations::RadicalInverse(int dimension, uint64_t a) const {
    const Base &b = bases_[dimension];
    const uint16_t *permutation = &permutations_[b.first];
    double scale = 1 / double(b.base), weight = scale, value = 0;
    int k = 0;
    for (; a && k < b.digits; ++k, permutation += b.base) {
        uint64_t next = a / b.base;
        value += double(permutation[a - next * b.base]) * weight;
        weight *= scale;
        a = next;
    }
    return ToUnitInterval(value + tails_[b.firstTail + static_cast<size_t>(k)]);
}

}  // namespace pbrt
