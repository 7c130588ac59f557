/* getopt and getopt_long with this library's own variables; part of shim.c.
 *
 * Options and other arguments may be mixed. The other arguments are moved behind the options, unless the option string begins
 * with '+'. Source of the behaviour: POSIX, getopt; the GNU extensions that programs rely on. */
#include <getopt.h>

WEAK char *optarg;
WEAK int optind = 1;
WEAK int opterr = 1;
WEAK int optopt = '?';

static const char *next_letter; /* within a group such as -abc */
static int skipped;             /* number of non-option arguments before the current one */

/* Moves the next option in front of the non-option arguments; returns 0 if there is no option. */
static int to_next_option(int argc, char **argv, int may_move)
{
    int at = optind;
    char *option;
    if (may_move)
        while (at < argc && (argv[at][0] != '-' || argv[at][1] == '\0'))
            at++;
    if (at >= argc || argv[at][0] != '-' || argv[at][1] == '\0')
        return 0;
    option = argv[at];
    skipped = at - optind;
    for (; at > optind; at--)
        argv[at] = argv[at - 1];
    argv[at] = option;
    return 1;
}

/* Moves the argument of an option next to it, past the non-option arguments between them. */
static char *take_argument(int argc, char **argv)
{
    int at = optind + skipped;
    char *argument;
    if (at >= argc)
        return NULL;
    argument = argv[at];
    for (; at > optind; at--)
        argv[at] = argv[at - 1];
    argv[at] = argument;
    optind++;
    return argument;
}

static void complain_of(char **argv, const char *what, const char *option, int len)
{
    if (opterr)
        libc_fprintf(stderr, "%s: %s -- '%.*s'\n", argv[0], what, len, option);
}

static int long_option(int argc, char **argv, const char *letters, const struct option *options, int *index,
                       const char *text)
{
    size_t len = strcspn(text, "=");
    int i, found = -1, matches = 0;
    for (i = 0; options[i].name != NULL; i++)
        if (strncmp(options[i].name, text, len) == 0) {
            found = i;
            if (strlen(options[i].name) == len) {
                matches = 1;
                break;
            }
            matches++;
        }
    optopt = 0;
    if (matches != 1) {
        complain_of(argv, matches == 0 ? "unrecognized option" : "ambiguous option", text, (int)len);
        return '?';
    }
    if (text[len] == '=' && options[found].has_arg == no_argument) {
        optopt = options[found].val;
        complain_of(argv, "option takes no argument", text, (int)len);
        return '?';
    }
    if (text[len] == '=')
        optarg = (char *)text + len + 1;
    else if (options[found].has_arg == required_argument && (optarg = take_argument(argc, argv)) == NULL) {
        optopt = options[found].val;
        if (letters[0] == ':')
            return ':';
        complain_of(argv, "option requires an argument", text, (int)len);
        return '?';
    }
    if (index != NULL)
        *index = found;
    if (options[found].flag == NULL)
        return options[found].val;
    *options[found].flag = options[found].val;
    return 0;
}

static int next_option(int argc, char **argv, const char *letters, const struct option *options, int *index)
{
    const char *known;
    int may_move = letters[0] != '+', letter;
    if (!may_move)
        letters++;
    optarg = NULL;
    if (optind == 0) {
        optind = 1;
        next_letter = NULL;
    }
    if (next_letter == NULL || *next_letter == '\0') {
        if (!to_next_option(argc, argv, may_move))
            return -1;
        next_letter = NULL;
        optind++;
        if (strcmp(argv[optind - 1], "--") == 0)
            return -1;
        if (options != NULL && argv[optind - 1][1] == '-')
            return long_option(argc, argv, letters, options, index, argv[optind - 1] + 2);
        next_letter = argv[optind - 1] + 1;
    }
    letter = *next_letter++;
    known = letter == ':' ? NULL : strchr(letters, letter);
    if (known == NULL) {
        optopt = letter;
        if (letters[0] != ':')
            complain_of(argv, "invalid option", next_letter - 1, 1);
        return '?';
    }
    if (known[1] != ':')
        return letter;
    if (*next_letter != '\0')
        optarg = (char *)next_letter;
    else if (known[2] != ':' && (optarg = take_argument(argc, argv)) == NULL) {
        optopt = letter;
        if (letters[0] == ':')
            return ':';
        complain_of(argv, "option requires an argument", next_letter - 1, 1);
        next_letter = NULL;
        return '?';
    }
    next_letter = NULL;
    return letter;
}

LIBC(int, getopt, (int argc, char *const *argv, const char *letters))
{
    return next_option(argc, (char **)argv, letters, NULL, NULL);
}
LIBC(int, getopt_long, (int argc, char *const *argv, const char *letters, const struct option *options, int *index))
{
    return next_option(argc, (char **)argv, letters, options, index);
}
