/**
 * @file
 * The C++ side of sightlines: owners of handles, containers in place of buffers, exceptions in place of statuses. C++17, header only,
 * on top of sightlines.h, which documents what every function does.
 *
 * All failures throw sightlines::error. Owners can be moved and not copied; a table may go before its viewers. Threads: as in
 * sightlines.h.
 */
#ifndef SIGHTLINES_HPP
#define SIGHTLINES_HPP

#include "sightlines.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace sightlines {

/** Why a call did nothing. */
class error : public std::runtime_error {
public:
    explicit error(sl_status status)
        : std::runtime_error(std::string(sl_status_name(status)) + ": " + sl_last_error()), status_(status) {}

    /** SL_ERROR_... */
    sl_status status() const noexcept { return status_; }

private:
    sl_status status_;
};

/** Throws unless the call did what it is for. */
inline void check(sl_status status) {
    if (status != SL_OK) {
        throw error(status);
    }
}

/** Throws if the library does not fit the header that this was compiled with. Every constructor of a table calls it. */
inline void check_version() { check(sl_check_version(SL_VERSION)); }

using point = std::array<double, 3>;

namespace detail {

/** Fills a container of the caller's with what a function of the C interface counts and copies; its memory is used again. */
template <typename T, typename Call>
void fill(std::vector<T> &out, Call call) {
    std::size_t count = 0;
    out.resize(out.capacity());
    sl_status status = call(out.empty() ? nullptr : out.data(), out.size(), &count);
    if (status == SL_ERROR_BUFFER || (status == SL_OK && count > out.size())) {
        out.resize(count);
        status = call(out.data(), out.size(), &count);
    }
    out.resize(status == SL_OK ? count : 0);
    check(status);
}

template <typename T, typename Call>
std::vector<T> filled(Call call) {
    std::vector<T> out;
    fill(out, call);
    return out;
}

template <typename Call>
std::string text(Call call) {
    std::size_t length = 0;
    check(call(nullptr, 0, &length));
    std::string out(length + 1, '\0');
    check(call(&out[0], out.size(), &length));
    out.resize(length);
    return out;
}

} // namespace detail

/** A scene that is being put together. */
class scene {
public:
    scene() {
        sl_scene *made = nullptr;
        check(sl_scene_new(&made));
        handle_.reset(made);
    }

    /** Corners as x, y, z one after the other; three indices for each triangle. Returns the number of the object. */
    std::uint32_t add(const std::string &name, const std::vector<double> &corners,
                      const std::vector<std::uint32_t> &indices, std::uint32_t flags = 0) {
        std::uint32_t object = 0;
        check(sl_scene_add_object(handle_.get(), name.c_str(), corners.data(), whole(corners.size()), indices.data(),
                                  indices.size(), flags, &object));
        return object;
    }

    /** The same in single precision. */
    std::uint32_t add_f32(const std::string &name, const std::vector<float> &corners,
                          const std::vector<std::uint32_t> &indices, std::uint32_t flags = 0) {
        std::uint32_t object = 0;
        check(sl_scene_add_object_f32(handle_.get(), name.c_str(), corners.data(), whole(corners.size()), indices.data(),
                                      indices.size(), flags, &object));
        return object;
    }

    /** The object moves, and never leaves the box. */
    void set_motion(std::uint32_t object, const sl_box &within) {
        check(sl_scene_set_motion(handle_.get(), object, &within));
    }

    sl_scene *get() const noexcept { return handle_.get(); }

private:
    static std::size_t whole(std::size_t coordinates) {
        if (coordinates % 3 != 0) {
            throw std::invalid_argument("corners have three coordinates each");
        }
        return coordinates / 3;
    }

    struct deleter {
        void operator()(sl_scene *handle) const noexcept { sl_scene_free(handle); }
    };
    std::unique_ptr<sl_scene, deleter> handle_;
};

/** A visibility table. Any number of threads may use one at once. */
class table {
public:
    /** Takes a handle over. */
    explicit table(sl_table *handle) noexcept : handle_(handle) {}

    static table load(const std::string &path) {
        return made([&](sl_table **out) { return sl_table_load(path.c_str(), out); });
    }

    static table from_bytes(const void *bytes, std::size_t size) {
        return made([&](sl_table **out) { return sl_table_from_bytes(static_cast<const std::uint8_t *>(bytes), size, out); });
    }

    std::vector<std::uint8_t> bytes(std::uint32_t form = SL_FORM_PLAIN) const {
        return detail::filled<std::uint8_t>([&](auto *to, std::size_t n, std::size_t *count) {
            return sl_table_bytes(get(), form, to, n, count);
        });
    }

    void save(const std::string &path, std::uint32_t form = SL_FORM_PLAIN) const {
        check(sl_table_save(get(), path.c_str(), form));
    }

    sl_table_info info() const {
        sl_table_info info{};
        info.struct_size = sizeof info;
        check(sl_table_get_info(get(), &info));
        return info;
    }

    sl_cell cell(std::uint32_t cell) const {
        sl_cell out{};
        check(sl_table_cell(get(), cell, &out));
        return out;
    }

    sl_object object(std::uint32_t object) const {
        sl_object out{};
        check(sl_table_object(get(), object, &out));
        return out;
    }

    sl_portal portal(std::uint32_t portal) const {
        sl_portal out{};
        check(sl_table_portal(get(), portal, &out));
        return out;
    }

    sl_door door(std::uint32_t door) const {
        sl_door out{};
        check(sl_table_door(get(), door, &out));
        return out;
    }

    std::string cell_name(std::uint32_t cell) const {
        return detail::text([&](char *to, std::size_t n, std::size_t *length) {
            return sl_table_cell_name(get(), cell, to, n, length);
        });
    }

    std::string object_name(std::uint32_t object) const {
        return detail::text([&](char *to, std::size_t n, std::size_t *length) {
            return sl_table_object_name(get(), object, to, n, length);
        });
    }

    std::string door_name(std::uint32_t door) const {
        return detail::text([&](char *to, std::size_t n, std::size_t *length) {
            return sl_table_door_name(get(), door, to, n, length);
        });
    }

    /** The first object of that name; throws if there is none. */
    std::uint32_t find_object(const std::string &name) const {
        std::uint32_t object = 0;
        check(sl_table_find_object(get(), name.c_str(), &object));
        return object;
    }

    /** The cells at a point; none outside, where everything has to be drawn. */
    std::vector<std::uint32_t> cells_at(const point &at) const {
        return detail::filled<std::uint32_t>([&](auto *to, std::size_t n, std::size_t *count) {
            return sl_table_cells_at(get(), at.data(), to, n, count);
        });
    }

    bool sees(std::uint32_t a, std::uint32_t b) const {
        std::uint32_t answer = 0;
        check(sl_table_sees(get(), a, b, &answer));
        return answer != 0;
    }

    std::vector<std::uint32_t> visible_cells(std::uint32_t cell) const {
        return detail::filled<std::uint32_t>([&](auto *to, std::size_t n, std::size_t *count) {
            return sl_table_visible_cells(get(), cell, to, n, count);
        });
    }

    std::vector<std::uint32_t> visible_objects(std::uint32_t cell) const {
        return detail::filled<std::uint32_t>([&](auto *to, std::size_t n, std::size_t *count) {
            return sl_table_visible_objects(get(), cell, to, n, count);
        });
    }

    /** What to draw from a point; everything outside. */
    std::vector<std::uint32_t> visible_objects_at(const point &at) const {
        return detail::filled<std::uint32_t>([&](auto *to, std::size_t n, std::size_t *count) {
            return sl_table_visible_objects_at(get(), at.data(), to, n, count, nullptr);
        });
    }

    sl_table *get() const noexcept { return handle_.get(); }

    /** Makes a table by a function of the C interface that stores a handle. */
    template <typename Call>
    static table made(Call call) {
        check_version();
        sl_table *out = nullptr;
        check(call(&out));
        return table(out);
    }

private:
    struct deleter {
        void operator()(sl_table *handle) const noexcept { sl_table_free(handle); }
    };
    std::unique_ptr<sl_table, deleter> handle_;
};

/** What follows one eye: one for each thread that looks. */
class viewer {
public:
    explicit viewer(const table &of) {
        sl_viewer *made = nullptr;
        check(sl_viewer_new(of.get(), &made));
        handle_.reset(made);
    }

    void set_method(std::uint32_t method, std::uint64_t max_steps = SL_STEPS_FRAME) {
        check(sl_viewer_set_method(get(), method, max_steps));
    }

    void close_portal(std::uint32_t portal) { check(sl_viewer_close_portal(get(), portal)); }
    void open_portal(std::uint32_t portal) { check(sl_viewer_open_portal(get(), portal)); }
    void close_door(const std::string &name) { check(sl_viewer_close_doors_named(get(), name.c_str())); }
    void open_door(const std::string &name) { check(sl_viewer_open_doors_named(get(), name.c_str())); }
    void open_all() { check(sl_viewer_open_all(get())); }

    sl_answer look(const sl_view &view) {
        sl_answer answer{};
        check(sl_viewer_look(get(), &view, &answer));
        return answer;
    }

    /** What the last look sees, into a list whose memory is used again: what to draw. */
    void objects(std::vector<std::uint32_t> &out) const {
        detail::fill(out, [&](auto *to, std::size_t n, std::size_t *count) { return sl_viewer_objects(get(), to, n, count); });
    }

    void cells(std::vector<std::uint32_t> &out) const {
        detail::fill(out, [&](auto *to, std::size_t n, std::size_t *count) { return sl_viewer_cells(get(), to, n, count); });
    }

    void portals(std::vector<std::uint32_t> &out) const {
        detail::fill(out, [&](auto *to, std::size_t n, std::size_t *count) { return sl_viewer_portals(get(), to, n, count); });
    }

    sl_viewer *get() const noexcept { return handle_.get(); }

private:
    struct deleter {
        void operator()(sl_viewer *handle) const noexcept { sl_viewer_free(handle); }
    };
    std::unique_ptr<sl_viewer, deleter> handle_;
};

/** Who may soon see whom, tick by tick: a server's side of a table. */
class relevance {
public:
    /** `reaches` is the path of a file that `sightlines relevance` made of this table; empty to find the usual ones now. */
    explicit relevance(const table &of, const std::string &reaches = {}, const sl_relevance_options *options = nullptr) {
        sl_relevance *made = nullptr;
        check(sl_relevance_new(of.get(), reaches.empty() ? nullptr : reaches.c_str(), options, &made));
        handle_.reset(made);
    }

    sl_changes update(double now, const std::vector<sl_player> &players) {
        sl_changes changes{};
        check(sl_relevance_update(get(), now, players.data(), players.size(), &changes));
        return changes;
    }

    /** Two numbers for each pair: who is told and of whom. */
    void gained(std::vector<std::uint32_t> &out) const {
        detail::fill(out, [&](auto *to, std::size_t n, std::size_t *count) { return sl_relevance_gained(get(), to, n, count); });
    }

    void lost(std::vector<std::uint32_t> &out) const {
        detail::fill(out, [&](auto *to, std::size_t n, std::size_t *count) { return sl_relevance_lost(get(), to, n, count); });
    }

    void shown_to(std::uint32_t player, std::vector<std::uint32_t> &out) const {
        detail::fill(out, [&](auto *to, std::size_t n, std::size_t *count) {
            return sl_relevance_shown_to(get(), player, to, n, count);
        });
    }

    bool is_shown(std::uint32_t to, std::uint32_t of) const {
        std::uint32_t shown = 1;
        check(sl_relevance_is_shown(get(), to, of, &shown));
        return shown != 0;
    }

    sl_relevance *get() const noexcept { return handle_.get(); }

private:
    struct deleter {
        void operator()(sl_relevance *handle) const noexcept { sl_relevance_free(handle); }
    };
    std::unique_ptr<sl_relevance, deleter> handle_;
};

/** A picture whose height takes the angle, in radians. */
inline sl_view perspective(const point &eye, const point &direction, const point &up, double vertical_angle, double aspect) {
    sl_view view{};
    view.kind = SL_VIEW_PERSPECTIVE;
    for (std::size_t k = 0; k < 3; ++k) {
        view.eye[k] = eye[k];
        view.direction[k] = direction[k];
        view.up[k] = up[k];
    }
    view.field_of_view = vertical_angle;
    view.aspect = aspect;
    return view;
}

/** Receives progress; returns whether to go on. It may throw: the bake is cancelled, and what was thrown leaves bake(). */
using progress = std::function<bool(const sl_progress &)>;

/** Makes the table of a scene. The struct_size, progress and user of the options are set here. */
inline table bake(const scene &of, sl_bake_options options = {}, const progress &report = {}) {
    struct guarded {
        const progress *call;
        std::exception_ptr thrown;

        static std::int32_t run(void *user, const sl_progress *so_far) noexcept {
            auto *self = static_cast<guarded *>(user);
            try {
                return (*self->call)(*so_far) ? 0 : 1;
            } catch (...) {
                self->thrown = std::current_exception();
                return 1;
            }
        }
    };
    guarded call{&report, nullptr};
    options.struct_size = sizeof options;
    options.progress = report ? &guarded::run : nullptr;
    options.user = &call;
    check_version();
    sl_table *out = nullptr;
    const sl_status status = sl_bake(of.get(), &options, &out, nullptr);
    table made(out);
    if (call.thrown) {
        std::rethrow_exception(call.thrown);
    }
    check(status);
    return made;
}

} // namespace sightlines

#endif
