/* Saved states in the hands of a host. A seal in front holds their size, model and checksum, so that bytes that were cut,
 * lengthened or changed, and states of another model, are refused. */
#ifndef SEALED_H
#define SEALED_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

enum { SEALED_PROBLEM = 160 };

typedef struct {
    unsigned long long size, model, checksum; /* in bytes, with the seal; hash of the owner; hash of the block */
} seal;

#define SEAL_BEGIN 14695981039346656037ULL

/* In the manner of Fowler, Noll and Vo, by words: each step can be undone, so that another word gives another hash. */
static inline unsigned long long seal_hash(unsigned long long hash, const void *bytes, size_t size) {
    const char *at = (const char *)bytes;
    while (size > 0) {
        unsigned long long word = 0;
        const size_t part = size < sizeof word ? size : sizeof word;
        memcpy(&word, at, part);
        hash = (hash ^ word) * 1099511628211ULL;
        hash ^= hash >> 29;
        at += part;
        size -= part;
    }
    return hash;
}

/* Return the hash of a model's token, which modelDescription.xml and binary have in common. */
static inline unsigned long long seal_model(const char *token) { return seal_hash(SEAL_BEGIN, token, strlen(token)); }

static inline size_t sealed_size(size_t block) { return sizeof(seal) + block; }
static inline void *sealed_block(void *state) { return (char *)state + sizeof(seal); }
static inline const void *sealed_content(const void *state) { return (const char *)state + sizeof(seal); }

/* Put the seal in front of a block, for which there is room before it. */
static inline void seal_state(void *state, unsigned long long model, size_t block) {
    seal head;
    head.size = sealed_size(block);
    head.model = model;
    head.checksum = seal_hash(SEAL_BEGIN, sealed_content(state), block);
    memcpy(state, &head, sizeof head);
}

/* Return whether a state is one of this model, for any content of its block. Only then does it have its full size. */
static inline bool seal_is_of(const void *state, unsigned long long model, size_t block) {
    seal head;
    memcpy(&head, state, sizeof head);
    return head.size == sealed_size(block) && head.model == model;
}

/* Return whether `size` bytes are a complete, unchanged state of this model; false, with one message, if not. */
static inline bool seal_holds(const void *state, size_t size, unsigned long long model, size_t block,
                              char problem[SEALED_PROBLEM]) {
    seal head;
    problem[0] = '\0';
    memset(&head, 0, sizeof head);
    if (state && size >= sizeof head) memcpy(&head, state, sizeof head);
    if (!state) {
        snprintf(problem, SEALED_PROBLEM, "The saved state must be given; got a null pointer.");
    } else if (size >= sizeof head && head.model != model) {
        snprintf(problem, SEALED_PROBLEM, "A saved state must be of this FMU with the same resources; got another one.");
    } else if (size != sealed_size(block)) {
        snprintf(problem, SEALED_PROBLEM, "A saved state of this FMU must have %zu bytes; got %zu. Pass it unchanged.",
                 sealed_size(block), size);
    } else {
        if (head.size != size || head.checksum != seal_hash(SEAL_BEGIN, sealed_content(state), block))
            snprintf(problem, SEALED_PROBLEM, "A saved state must be unchanged; got one whose checksum differs.");
    }
    return !problem[0];
}

#endif
