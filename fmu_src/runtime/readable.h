/* Make text from any source safe to show: valid UTF-8 on one line. */
#ifndef READABLE_H
#define READABLE_H

#include <stddef.h>

/* Return the bytes of the letter that begins here; 0 if none does, or if it is a control character. Unicode 15, table 3-7. */
static inline size_t length_of_letter(const unsigned char *c) {
    if (c[0] < 0x80) return c[0] >= ' ' && c[0] != 0x7F;
    if (c[0] < 0xC2 || c[0] > 0xF4) return 0;
    const size_t length = c[0] < 0xE0 ? 2 : c[0] < 0xF0 ? 3 : 4;
    const unsigned char lowest = c[0] == 0xE0 ? 0xA0 : c[0] == 0xF0 ? 0x90 : 0x80;
    const unsigned char highest = c[0] == 0xED ? 0x9F : c[0] == 0xF4 ? 0x8F : 0xBF;
    if (c[1] < lowest || c[1] > highest) return 0;
    for (size_t i = 2; i < length; ++i)
        if (c[i] < 0x80 || c[i] > 0xBF) return 0;
    return length;
}

/* Replace each byte that belongs to no UTF-8 letter by a question mark. */
static inline void make_readable(char *text) {
    for (unsigned char *c = (unsigned char *)text; *c;) {
        const size_t length = length_of_letter(c);
        if (!length) *c = '?';
        c += length ? length : 1;
    }
}

#endif
