// A thin C++17 wrapper of stickslip.h: handles that free themselves, errors as exceptions. Header only, no second library.
//
// What a call does, its units and its errors are documented in stickslip.h; the threads rules there hold here. Arrays
// are passed as stickslip::Span, which std::vector, std::array, C arrays, std::span and braces of numbers convert to; unlike
// std::span it also takes containers that are temporary, where it only reads: they live until the end of the call.
#ifndef STICKSLIP_HPP
#define STICKSLIP_HPP

#include "stickslip.h"

#include <cstddef>
#include <initializer_list>
#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

namespace stickslip {

// A failed call: what() is the library's message, code() one of stickslip_code.
class Error : public std::runtime_error {
public:
    Error(std::int32_t code, const std::string &what) : std::runtime_error(what), code_(code) {}
    std::int32_t code() const noexcept { return code_; }

private:
    std::int32_t code_;
};

// Message of the last call on this thread that failed or left a note.
inline std::string last_error() {
    std::string text(stickslip_last_error(nullptr, 0) + 1, '\0');
    stickslip_last_error(&text[0], text.size());
    text.pop_back();
    return text;
}

// Passes on STICKSLIP_OK and notes, throws codes.
inline std::int32_t check(std::int32_t code) {
    if (code < 0) throw Error(code, last_error());
    return code;
}

// Values that belong to someone else.
template <class T> class Span {
    // A pointer to values of another class that converts, as that of a base, would be read with the wrong stride.
    template <class P>
    static constexpr bool is_of_values =
        std::is_pointer_v<P> && std::is_convertible_v<std::remove_pointer_t<P> (*)[], T (*)[]>;

public:
    constexpr Span(T *data, std::size_t size) noexcept : data_(data), size_(size) {}
    // C arrays.
    template <std::size_t N> constexpr Span(T (&array)[N]) noexcept : data_(array), size_(N) {}
    // Containers with data() and size(), of these very values.
    template <class C, class = std::enable_if_t<is_of_values<decltype(std::declval<C &>().data())>>>
    constexpr Span(C &container) noexcept : data_(container.data()), size_(container.size()) {}
    template <class C, class = std::enable_if_t<std::is_const_v<T> && is_of_values<decltype(std::declval<const C &>().data())>>>
    constexpr Span(const C &container) noexcept : data_(container.data()), size_(container.size()) {}
    // Braces; they live until the end of the call.
    template <class U = T, class = std::enable_if_t<std::is_const_v<U>>>
    constexpr Span(std::initializer_list<std::remove_const_t<T>> list) noexcept
        : data_(first(list)), size_(list.size()) {}
    constexpr T *data() const noexcept { return data_; }
    constexpr std::size_t size() const noexcept { return size_; }

private:
    static constexpr T *first(std::initializer_list<std::remove_const_t<T>> list) noexcept { return list.begin(); }
    T *data_;
    std::size_t size_;
};

namespace detail {
struct Free {
    void operator()(stickslip_model *p) const noexcept { stickslip_model_free(p); }
    void operator()(stickslip_simulator *p) const noexcept { stickslip_free(p); }
    void operator()(stickslip_state *p) const noexcept { stickslip_state_free(p); }
};
template <class T> using Handle = std::unique_ptr<T, Free>;
} // namespace detail

// A compiled scene; shared by simulators, usable from all threads.
class Model {
public:
    // Compiles a scene file with the files of its folder.
    static Model compile_file(const std::string &path) {
        stickslip_model *model = nullptr;
        check(stickslip_model_compile_file(path.c_str(), nullptr, nullptr, &model));
        return Model(model);
    }
    static Model compile(const std::string &scene) {
        stickslip_model *model = nullptr;
        check(stickslip_model_compile(scene.c_str(), &model));
        return Model(model);
    }
    static Model load(Span<const std::uint8_t> bytes) {
        stickslip_model *model = nullptr;
        check(stickslip_model_load(bytes.data(), bytes.size(), &model));
        return Model(model);
    }
    std::vector<std::uint8_t> save() const {
        std::size_t length = 0;
        check(stickslip_model_save(get(), nullptr, 0, &length));
        std::vector<std::uint8_t> bytes(length);
        check(stickslip_model_save(get(), bytes.data(), bytes.size(), &length));
        return bytes;
    }
    stickslip_model_info info() const {
        stickslip_model_info info;
        check(stickslip_model_get_info(get(), &info));
        return info;
    }
    // The texts of a port live as long as the model.
    stickslip_port port(const std::string &name) const {
        stickslip_port port;
        check(stickslip_model_find_port(get(), name.c_str(), &port));
        return port;
    }
    stickslip_port port(std::uint32_t reference) const {
        stickslip_port port;
        check(stickslip_model_get_port(get(), reference, &port));
        return port;
    }
    stickslip_model *get() const noexcept { return handle_.get(); }

private:
    explicit Model(stickslip_model *model) : handle_(model) {}
    detail::Handle<stickslip_model> handle_;
};

// Room for a saved state.
class State {
public:
    explicit State(stickslip_state *state) : handle_(state) {}
    stickslip_state *get() const noexcept { return handle_.get(); }

private:
    detail::Handle<stickslip_state> handle_;
};

// One simulation; used by one thread at a time.
class Simulator {
public:
    explicit Simulator(const Model &model) : Simulator(make(model)) {}

    void init(double time) { check(stickslip_init(get(), time)); }
    void reset() { check(stickslip_reset(get())); }
    void set_inputs(Span<const double> values) { check(stickslip_set_inputs(get(), values.data(), values.size())); }
    // One of STICKSLIP_INPUTS_...; before init.
    void set_inputs_meaning(std::int32_t meaning) { check(stickslip_set_inputs_meaning(get(), meaning)); }
    void set_input_slope(std::uint32_t reference, double slope) {
        check(stickslip_set_input_slope(get(), reference, slope));
    }
    void clear_input_slope(std::uint32_t reference) { check(stickslip_clear_input_slope(get(), reference)); }
    void set(std::uint32_t reference, double value) { check(stickslip_set(get(), reference, value)); }
    // All or nothing: the values of the ports one after the other, of an array all of them.
    void set(Span<const std::uint32_t> references, Span<const double> values) {
        check(stickslip_set_values(get(), references.data(), references.size(), values.data(), values.size()));
    }
    // STICKSLIP_OK, STICKSLIP_NOT_UNIQUE, STICKSLIP_AT_ROUNDING or STICKSLIP_DIGITS_LOST.
    std::int32_t do_step(double time, double step) { return check(stickslip_do_step(get(), time, step)); }
    void get_outputs(Span<double> values) const { check(stickslip_get_outputs(get(), values.data(), values.size())); }
    void get(std::uint32_t reference, Span<double> values) const {
        check(stickslip_get(get(), reference, values.data(), values.size()));
    }
    double time() const {
        double time = 0.0;
        check(stickslip_get_time(get(), &time));
        return time;
    }

    Simulator clone() const {
        stickslip_simulator *copy = nullptr;
        check(stickslip_clone(get(), &copy));
        return Simulator(copy, size());
    }
    State new_state() const {
        stickslip_state *state = nullptr;
        check(stickslip_state_new(get(), &state));
        return State(state);
    }
    void save(State &state) const { check(stickslip_save_state(get(), state.get())); }
    void restore(const State &state) { check(stickslip_restore_state(get(), state.get())); }
    std::vector<std::uint8_t> serialize() const {
        std::size_t length = 0;
        check(stickslip_serialize(get(), nullptr, 0, &length));
        std::vector<std::uint8_t> bytes(length);
        check(stickslip_serialize(get(), bytes.data(), bytes.size(), &length));
        return bytes;
    }
    void deserialize(Span<const std::uint8_t> bytes) { check(stickslip_deserialize(get(), bytes.data(), bytes.size())); }

    // (d outputs / d inputs) seed of the last step.
    std::vector<double> directional_derivative(Span<const double> seed) {
        std::vector<double> out(outputs_);
        check(stickslip_directional_derivative(get(), seed.data(), seed.size(), out.data(), out.size()));
        return out;
    }
    // (d outputs / d inputs)^T seed of the last step.
    std::vector<double> adjoint_derivative(Span<const double> seed) {
        std::vector<double> out(inputs_);
        check(stickslip_adjoint_derivative(get(), seed.data(), seed.size(), out.data(), out.size()));
        return out;
    }
    stickslip_simulator *get() const noexcept { return handle_.get(); }

private:
    struct Size {
        std::size_t inputs, outputs;
    };
    Simulator(stickslip_simulator *simulator, Size size)
        : handle_(simulator), inputs_(size.inputs), outputs_(size.outputs) {}
    static Simulator make(const Model &model) {
        const stickslip_model_info info = model.info();
        stickslip_simulator *simulator = nullptr;
        check(stickslip_new(model.get(), &simulator));
        return Simulator(simulator, Size{info.inputs, info.outputs});
    }
    Size size() const noexcept { return Size{inputs_, outputs_}; }

    detail::Handle<stickslip_simulator> handle_;
    std::size_t inputs_, outputs_;
};

} // namespace stickslip

#endif
