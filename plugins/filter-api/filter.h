/* The filter contract for C: a filter turns a frame into a frame.
 *
 * The law in prose stands in README.md beside this file. In short:
 *
 *   - Frames are row-major, top row first, left pixel first. Row y begins at pixels + y * stride_bytes.
 *   - The same frame and parameters give the same output, whatever was processed before; or, of a filter that keeps
 *     something, the same frames and movements since it was created or loaded.
 *   - The host owns every frame, text buffer and array of values that it passes; the filter owns its instance.
 *   - Instances are independent: different ones may run at the same time on different threads, one instance never
 *     runs twice at once.
 *   - Everything that a filter_plugin points to lives as long as the library.
 *
 * A filter is one file: define the three functions, fill a filter_plugin, and end with FILTER_EXPORT. See
 * ../examples/contrast.c. Nothing but this header is needed, for a native library or for WebAssembly:
 *
 *   cc -O2 -shared -fPIC -I. -o contrast.so ../examples/contrast.c
 *   clang --target=wasm32 -O2 -nostdlib -Wl,--no-entry -I. -o contrast.wasm ../examples/contrast.c
 */
#ifndef ENGINE_FILTER_H
#define ENGINE_FILTER_H

#include <stddef.h>
#include <stdint.h>

/* The version of this contract. A host loads filters of its own version and of older ones; version 1 ended after
 * `destroy`. */
#define FILTER_ABI_VERSION 2u

/* What one pixel holds; also the bits of filter_plugin.reads. */
enum {
    FILTER_RGB = 1,  /* three bytes: red, green, blue */
    FILTER_GREY = 2, /* one byte of brightness */
    FILTER_MASK = 4, /* one byte, 0 or 255 */

    /* Only in filter_plugin.reads, beside FILTER_RGB and FILTER_GREY: of colour the filter sees the brightness alone, so
     * that a host may pass (77 R + 150 G + 29 B) / 256, rounded down, as a grey frame instead and get the same output. */
    FILTER_BRIGHTNESS = 8,

    /* A uint16_t, the lower byte first: nearness, one over the distance ahead of the lens, in 1/8192 1/m; 0 where nothing
     * was measured. */
    FILTER_DEPTH = 16
};

/* What kind of number a parameter is. */
enum {
    FILTER_NUMBER = 0, /* any finite number */
    FILTER_WHOLE = 1,  /* a whole number */
    FILTER_SWITCH = 2  /* 0 (off) or 1 (on) */
};

/* What create and process return. */
enum {
    FILTER_OK = 0,
    FILTER_ERROR = 1, /* the message says why */
    FILTER_PANIC = 2  /* the filter broke down; the message may say why */
};

/* The bytes of every message buffer, the ending 0 included. */
#define FILTER_MESSAGE_BYTES 256u

/* Text in UTF-8, which needs no ending 0. */
typedef struct {
    const char *bytes;
    uint32_t length;
} filter_text;

/* FILTER_TEXT("words") fills a filter_text. */
#define FILTER_TEXT(words) { (words), (uint32_t)(sizeof(words) - 1) }

/* One number that a user may set. */
typedef struct {
    double min;           /* the least value, included */
    double max;           /* the greatest value, included */
    double default_value; /* where the user gives none */
    filter_text name;     /* the key in a script: lower case letters, digits and _ */
    filter_text unit;     /* in words: grey levels */
    filter_text purpose;  /* one sentence: what it changes */
    uint32_t kind;        /* FILTER_NUMBER, FILTER_WHOLE or FILTER_SWITCH */
} filter_parameter;

/* One picture. */
typedef struct {
    uint32_t width_px;
    uint32_t height_px;
    uint32_t stride_bytes; /* from one row to the next */
    uint32_t format;       /* one of FILTER_RGB, FILTER_GREY, FILTER_MASK, FILTER_DEPTH */
    uint8_t *pixels;
} filter_frame;

/* How the camera is mounted. A point of the image x pixels right of its middle and y below it looks along
 * ahead + x / focal_px * right + y / focal_px * down; on flat ground its nearness is
 * (tilt_sin + y / focal_px * tilt_cos) / height_m, where that is positive. */
typedef struct {
    double focal_px;  /* of a fisheye, pixels for each radian */
    double forward_m; /* ahead of the robot's centre */
    double height_m;  /* above the ground */
    double tilt_sin;  /* of the angle by which it looks down */
    double tilt_cos;
    uint32_t fisheye; /* 1 if the lens is an equidistant fisheye */
} filter_mount;

/* How the robot moved since the last frame, as its wheels say. */
typedef struct {
    double driven_m;   /* backwards counts as forwards */
    double turned_rad; /* positive to the left */
    uint32_t jumped;   /* 1 if it was put elsewhere, and with the first frame of all; then the other two are 0 */
} filter_moved;

/* What a library says of itself, and its functions. */
typedef struct filter_plugin {
    uint32_t abi_version;     /* FILTER_ABI_VERSION; first, in every version */
    uint32_t plugin_bytes;    /* sizeof(filter_plugin) */
    uint32_t parameter_bytes; /* sizeof(filter_parameter) */
    uint32_t frame_bytes;     /* sizeof(filter_frame) */
    filter_text name;         /* as in scripts, and as the file is called: lower case letters, digits and _ */
    filter_text version;
    filter_text licence; /* an SPDX expression */
    filter_text purpose; /* one sentence: what it does */
    uint32_t reads;      /* the formats that it reads, as bits */
    uint32_t writes;     /* the format that it writes */
    uint32_t parameter_count;
    const filter_parameter *parameters;

    /* Makes an instance from parameter_count finite values, in order and within their ranges. *instance may be set to
     * NULL by a filter that keeps nothing. On failure it is left alone and the message, FILTER_MESSAGE_BYTES long, says
     * why. */
    int32_t (*create)(const double *values, uint32_t count, void **instance, char *message);

    /* Writes every pixel of output, which is as wide and as high as input and has the format `writes`. */
    int32_t (*process)(void *instance, const filter_frame *input, const filter_frame *output, char *message);

    /* Frees an instance. */
    void (*destroy)(void *instance);

    /* What follows came with version 2. Each may be NULL. */

    /* Hears how the camera is mounted: once, before the first frame. */
    int32_t (*mount)(void *instance, const filter_mount *mount, char *message);

    /* Hears how the robot moved: before each frame, if the filter keeps something. */
    void (*moved)(void *instance, const filter_moved *moved);

    /* How many bytes an instance keeps from frame to frame, the same number for all of its life; 0 for nothing. */
    uint32_t (*keeps)(void *instance);

    /* Writes all that the instance keeps into so many bytes. */
    void (*save)(void *instance, uint8_t *kept);

    /* Lets an instance go on as if it had seen and heard all that the one had that saved this, and nothing else. */
    int32_t (*load)(void *instance, const uint8_t *kept, uint32_t bytes, char *message);
} filter_plugin;

/* FILTER_EXPORT(.name = FILTER_TEXT("contrast"), ...); makes the library's one filter known to the host: everything of
 * filter_plugin from `name` on. Version and sizes are filled in. Once, at the end of the file. */
#define FILTER_PLUGIN_OF(...)                                                                                          \
    { FILTER_ABI_VERSION, (uint32_t)sizeof(filter_plugin), (uint32_t)sizeof(filter_parameter),                         \
      (uint32_t)sizeof(filter_frame), __VA_ARGS__ }

#if defined(__wasm__)
#define FILTER_EXPORT_AS(name) __attribute__((export_name(name), used))
#define FILTER_EXPORT(...)                                                                                             \
    static const filter_plugin filter_exported = FILTER_PLUGIN_OF(__VA_ARGS__);                                        \
    FILTER_EXPORT_AS("engine_filter") const filter_plugin *filter_export_plugin(void) { return &filter_exported; }     \
    FILTER_EXPORT_AS("engine_filter_create")                                                                           \
    int32_t filter_export_create(const double *values, uint32_t count, void **instance, char *message) {               \
        return filter_exported.create(values, count, instance, message);                                               \
    }                                                                                                                  \
    FILTER_EXPORT_AS("engine_filter_process")                                                                          \
    int32_t filter_export_process(void *instance, const filter_frame *input, const filter_frame *output,               \
                                  char *message) {                                                                     \
        return filter_exported.process(instance, input, output, message);                                              \
    }                                                                                                                  \
    FILTER_EXPORT_AS("engine_filter_mount")                                                                            \
    int32_t filter_export_mount(void *instance, const filter_mount *mount, char *message) {                            \
        return filter_exported.mount ? filter_exported.mount(instance, mount, message) : FILTER_OK;                    \
    }                                                                                                                  \
    FILTER_EXPORT_AS("engine_filter_moved") void filter_export_moved(void *instance, const filter_moved *moved) {      \
        if (filter_exported.moved) filter_exported.moved(instance, moved);                                             \
    }                                                                                                                  \
    FILTER_EXPORT_AS("engine_filter_keeps") uint32_t filter_export_keeps(void *instance) {                             \
        return filter_exported.keeps ? filter_exported.keeps(instance) : 0;                                            \
    }                                                                                                                  \
    FILTER_EXPORT_AS("engine_filter_save") void filter_export_save(void *instance, uint8_t *kept) {                    \
        if (filter_exported.save) filter_exported.save(instance, kept);                                                \
    }                                                                                                                  \
    FILTER_EXPORT_AS("engine_filter_load")                                                                             \
    int32_t filter_export_load(void *instance, const uint8_t *kept, uint32_t bytes, char *message) {                   \
        return filter_exported.load ? filter_exported.load(instance, kept, bytes, message) : FILTER_OK;                \
    }                                                                                                                  \
    /* Memory for the host's frames: whole pages, never freed; 0 when there is no more. */                             \
    FILTER_EXPORT_AS("engine_filter_allocate") void *filter_export_allocate(uint32_t bytes) {                          \
        size_t page = __builtin_wasm_memory_grow(0, (bytes + (size_t)65535) / 65536);                                  \
        return page == (size_t)-1 ? (void *)0 : (void *)(page * 65536);                                                \
    }                                                                                                                  \
    typedef int filter_exported_once
#elif defined(_WIN32)
#define FILTER_EXPORT(...) __declspec(dllexport) const filter_plugin engine_filter = FILTER_PLUGIN_OF(__VA_ARGS__)
#else
#define FILTER_EXPORT(...)                                                                                             \
    __attribute__((visibility("default"))) const filter_plugin engine_filter = FILTER_PLUGIN_OF(__VA_ARGS__)
#endif

#endif
