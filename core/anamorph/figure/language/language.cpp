// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/language/language.h"

#include <algorithm>

#include "anamorph/error.h"
#include "anamorph/figure/language/script_table.h"
#include "anamorph/parameter/parameter.h"

namespace anamorph::figure {
namespace {

struct Said {
    std::string_view word, meaning, example;
};

// Examples stand in the script of example_of. Of a declaration they are nothing: that script has it.
constexpr Said kSaid[] = {
    {"figure", "declares a figure: its name, how many ellipsoids it has, and their names", ""},
    {"ellipsoid", "declares an ellipsoid by half its lengths along x, y and z", ""},
    {"joint", "joins two ellipsoids in a point, given from the centre of each as they stand at rest", ""},
    {"accelerate", "the action works in frames after the first up to the second, faster and faster",
     "accelerate 0 10 moveby doll trunk 100 0 0"},
    {"subroutine",
     "begins movements that calls perform, up to endsub; frames count from its own first. In the strict "
     "dialect it may have parameters: how many, and their names, which stand for what a call hands over",
     "call 0 5 wave\nsubroutine wave\nlinear 0 5 bendby arm shoulder trunk 90 z\nendsub wave"},
    {"balance",
     "turns the part of the figure on the ellipsoid's side of the joint, about an axis of the second, until "
     "its "
     "centre of mass is as high as it can be",
     "repeat 0 10 balance arm shoulder trunk z"},
    {"attach",
     "makes a joint between the ellipsoids of two figures, which become one; nothing moves. The place is "
     "from the "
     "first ellipsoid's centre, in the strict dialect from the second's",
     "repeat 0 1 attach trunk grip ball 0 100 0"},
    {"detach", "takes a joint away; what is on the ellipsoid's side becomes the new figure",
     "repeat 0 1 detach arm shoulder loose"},
    {"decelerate", "the action works in frames after the first up to the second, slower and slower",
     "decelerate 0 10 moveby doll trunk 100 0 0"},
    {"grofig", "multiplies the size of a figure by three factors, about the centre of the ellipsoid",
     "linear 0 10 grofig doll trunk 2 2 2"},
    {"spinto",
     "turns a figure about the centre of its ellipsoid, until that has the angles (a1 a2 a3) seen from the "
     "second",
     "linear 0 10 spinto doll trunk world 0 0 90"},
    {"moveby", "moves a figure by x, y, z along the axes of the ellipsoid",
     "linear 0 10 moveby doll world 100 0 0"},
    {"add", "sets the variable to the sum", "repeat 0 10 add u u 5"},
    {"touch",
     "turns the part on the third ellipsoid's side of the joint, about an axis of the fourth, until the "
     "first two "
     "touch",
     "repeat 0 1 touch arm ball arm world shoulder z"},
    {"stop", "ends the script; what follows is not read", ""},
    {"spinby",
     "turns a figure about the centre of its ellipsoid by an angle in degrees about an axis of the second",
     "linear 0 10 spinby doll trunk world 90 y"},
    {"ground", "moves a figure up or down until its lowest point is at y = 0", "repeat 0 1 ground doll"},
    {"bendby",
     "turns the part of the figure on the ellipsoid's side of the joint, about the joint, by an angle in "
     "degrees "
     "about an axis of the second ellipsoid",
     "linear 0 10 bendby arm shoulder trunk 90 z"},
    {"set", "sets the variable to a number, or to the name of anything", "repeat 0 1 set u 90"},
    {"bendto", "turns the same part until the ellipsoid has the angles (a1 a2 a3) seen from the second",
     "linear 0 10 bendto arm shoulder trunk 0 0 90"},
    {"debug",
     "with a number of 0 or less every action is told as it is performed: frame, place in the script, step "
     "of steps, operands",
     "debug 0"},
    {"repeat", "the action works in full in every frame after the first up to the second",
     "repeat 0 10 moveby doll trunk 10 0 0"},
    {"quadratic", "the action works faster and faster, and from half the way slower and slower",
     "quadratic 0 10 moveby doll trunk 100 0 0"},
    {"linear", "the action works in equal parts in the frames after the first up to the second",
     "linear 0 10 moveby doll trunk 100 0 0"},
    {"observe", "turns space before it is seen, about the place: by three angles in degrees about x, y and z",
     "linear 0 10 observe 0 90 0"},
    {"moveto", "moves a figure until the centre of its ellipsoid is at x, y, z",
     "linear 0 10 moveto doll trunk 500 400 500"},
    {"call",
     "performs a subroutine; its first frame is the one after the call's first, and it is cut off at the "
     "last. In the strict dialect values for its parameters may follow: how many, and these",
     "call 0 5 wave\nsubroutine wave\nlinear 0 5 bendby arm shoulder trunk 90 z\nendsub wave"},
    {"endsub", "ends a subroutine",
     "call 0 5 wave\nsubroutine wave\nlinear 0 5 bendby arm shoulder trunk 90 z\nendsub wave"},
    {"speed", "of k > 0: all frame numbers count k times; of k < 0: only every |k|th frame is shown",
     "speed 2"},
    {"invert", "sets the variable to 1 divided by it; 0 stays 0", "repeat 0 1 invert u"},
    {"variables", "declares variables: how many, and their names", ""},
    {"view", "only frames after the first up to the second are shown",
     "linear 0 10 moveby doll trunk 100 0 0\nview 2 8"},
    {"groell", "multiplies the half-lengths of an ellipsoid by three factors; joints stay",
     "linear 0 10 groell arm 1 2 1"},
    {"grojnt",
     "multiplies the size of an ellipsoid by three factors while the joint stays; what hangs on it follows",
     "linear 0 10 grojnt arm shoulder 1 2 1"},
    {"angles", "sets three variables to the angles (a1 a2 a3) of the first ellipsoid seen from the second",
     "repeat 0 10 angles arm world u v w"},
    {"centre", "sets three variables to the centre of an ellipsoid", "repeat 0 10 centre arm u v w"},
    {"flex",
     "turns the part on the ellipsoid's side of the joint about x of the other one; a joint whose name has "
     "kne in it "
     "bends the other way",
     "linear 0 10 flex arm shoulder 45"},
    {"rotate",
     "turns the same part about y of the ellipsoid itself; the first, third ... of a figure are left ones",
     "linear 0 10 rotate arm shoulder 45"},
    {"abduct", "turns the same part about z of the other ellipsoid; left ones and right ones outwards",
     "linear 0 10 abduct arm shoulder 45"},
    {"negate", "turns the sign of the variable", "repeat 0 1 negate u"},
    {"subtract", "sets the variable to the difference", "repeat 0 1 subtract u v 5"},
    {"divide", "sets the variable to the quotient", "repeat 0 1 divide u v 2"},
    {"multiply", "sets the variable to the product", "repeat 0 1 multiply u v 2"},
    {"cubic", "as quadratic, more slowly at both ends", "cubic 0 10 moveby doll trunk 100 0 0"},
    {"place", "moves what is seen in the middle of the window to x, y, z; at first it is 500 500 500",
     "linear 0 10 place 500 400 500"},
    {"axes", "sets three variables to the half-lengths of an ellipsoid", "repeat 0 10 axes arm u v w"},
    {"linkx", "sets three variables to the place of a joint", "repeat 0 10 linkx shoulder u v w"},
    {"colour", "moves the colour of an ellipsoid to red, green, blue, each from 0 to 255",
     "linear 0 10 colour arm 255 0 0"},
    {"print", "says the value of a variable in every frame", "repeat 0 10 print u"},
    {"texture", "gives an ellipsoid a picture, moved by x and y texels",
     "repeat 0 1 texture trunk shirt.png 0 0"},
    {"drag",
     "grounds what is beyond the joint, and turns the second ellipsoid's side of it until the first is as "
     "close to "
     "y = 0 as 10 degrees take it",
     "repeat 0 10 drag arm arm shoulder trunk z"},
    {"limit", "bounds the three angles of a joint; only the strict dialect keeps them",
     "limit shoulder -90 90 -90 90 -90 90"},
    {"abut", "slides the first ellipsoid's figure along an axis of the third until the first two touch",
     "repeat 0 1 abut ball trunk world x"},
    {"movjnt", "moves a joint, and all beyond it, by x, y, z in the axes of the ellipsoid",
     "linear 0 10 movjnt shoulder trunk 10 0 0"},
    {"growto", "grows a figure about the ellipsoid until its centres are so far apart along x, y and z",
     "linear 0 10 growto doll trunk 100 200 100"},
    {"color", "another spelling of colour", "linear 0 10 color arm 255 0 0"},
    {"center", "another spelling of centre", "repeat 0 10 center arm u v w"},
    {"opacty", "is read and does nothing", ""},
    {"lghtng", "is read and does nothing", ""},
    {"allow", "lets two ellipsoids pass through each other again", "repeat 0 1 allow arm trunk"},
    {"forbid",
     "forbids two ellipsoids to pass through each other: where they do, the script ends with an error",
     "repeat 0 1 forbid ball arm"},
    {"include", "reads another file in this place, which lies beside the script", ""},
};

const Said* said_of(std::string_view word) {
    const auto found =
        std::find_if(std::begin(kSaid), std::end(kSaid), [&](const Said& s) { return s.word == word; });
    return found == std::end(kSaid) ? nullptr : found;
}

/// A doll with an arm, and a ball that is a figure of its own.
std::string example_of(std::string_view statement) {
    std::string script =
        "figure doll 2 trunk arm\nfigure toy 1 ball\nellipsoid trunk 60 100 40\nellipsoid arm 20 80 20\n"
        "ellipsoid ball 30 30 30\njoint shoulder trunk 60 80 0 arm 0 75 0\nvariables 3 u v w\n"
        "repeat 0 1 set u 1\nrepeat 0 1 set v 2\n"
        "repeat 0 1 moveto doll trunk 500 500 500\nrepeat 0 1 moveto toy ball 700 500 500\n";
    if (!statement.empty()) script.append(statement) += '\n';
    return script + "stop\n";
}

}  // namespace

std::vector<LanguageWord> language_words() {
    std::vector<LanguageWord> words;
    for (const script_table::Entry& entry : script_table::entries())
        if (const Said* said = said_of(entry.word))
            words.push_back({std::string(entry.word), std::string(entry.usage), std::string(said->meaning),
                             example_of(said->example)});
    return words;
}

std::string language_page(std::string_view word) {
    const std::vector<LanguageWord> words = language_words();
    std::string page;
    if (word.empty()) {
        for (const LanguageWord& w : words)
            page += w.word + std::string(12 - w.word.size(), ' ') + w.operands + "\n";
        return page +
               "\nAny beginning of a word stands for the first that begins so. \"language WORD\" says "
               "more.\n";
    }
    // As the parser looks a word up.
    const auto found = std::find_if(words.begin(), words.end(),
                                    [&](const LanguageWord& w) { return w.word.starts_with(word); });
    if (found == words.end()) throw Error("\"" + printable(word) + "\" is not a word of the language");
    page = found->word;
    if (!found->operands.empty()) (page += ' ') += found->operands;
    return page + "\n\n    " + found->meaning + "\n\nFor example:\n\n" + found->example;
}

}  // namespace anamorph::figure
