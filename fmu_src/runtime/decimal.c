/* Numbers as files write them: with a point, whatever the language of the host, whose strtod may want a comma. */
#include "table_file.h"

bool table_read_number(const char *text, double *value) {
    static const double power[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                   1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    const bool negative = *text == '-';
    unsigned long long digits = 0;
    int exponent = 0, kept = 0;
    bool seen = false, behind = false;
    if (*text == '-' || *text == '+') ++text;
    for (; (*text >= '0' && *text <= '9') || (*text == '.' && !behind); ++text) {
        if (*text == '.') {
            behind = true;
            continue;
        }
        seen = true;
        exponent -= behind;
        if (kept < 18) {
            digits = 10 * digits + (unsigned long long)(*text - '0');
            kept += digits > 0;
        } else {
            ++exponent;
        }
    }
    if (seen && (*text == 'e' || *text == 'E')) {
        const bool down = text[1] == '-';
        int own = 0;
        text += text[1] == '-' || text[1] == '+' ? 2 : 1;
        if (!*text) return false;
        for (; *text >= '0' && *text <= '9'; ++text)
            if (own < 1000) own = 10 * own + *text - '0';
        exponent += down ? -own : own;
    }
    if (!seen || *text) return false;
    double size = (double)digits;
    for (; exponent > 0 && size > 0.0 && size < 1e300; exponent -= exponent < 22 ? exponent : 22)
        size *= power[exponent < 22 ? exponent : 22];
    for (; exponent < 0 && size > 0.0; exponent += exponent > -22 ? -exponent : 22)
        size /= power[exponent > -22 ? -exponent : 22];
    *value = negative ? -size : size;
    return true;
}
