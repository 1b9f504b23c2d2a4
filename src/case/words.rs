//! Words that other programs, or earlier versions, use for keys of a case, and the keys that they are here.

/// Words without spaces, dashes and underscores in lower case; the keys, of which the first that an object knows is meant; where that key stands.
const WORDS: [(&[&str], &[&str], &str); 28] = [
    (
        &["youngsmodulus", "young", "youngmodulus", "modulusofelasticity", "elasticmodulus", "eref"],
        &["E"],
        "of a body's `material`",
    ),
    (&["poissonsratio", "poissonratio", "poisson", "nuur"], &["nu"], "of a body's `material`"),
    (&["rho", "massdensity"], &["density"], "of a body's `material`"),
    (&["yieldstress", "yieldstrength", "sigy"], &["sigma_y"], "of a `von_mises` material"),
    (
        &["cohesion"],
        &["c"],
        "of a `mohr_coulomb` material; of an interface it is the `strength` of its contact's `bond`",
    ),
    (
        &["frictionangle", "angleoffriction"],
        &["phi"],
        "of a `mohr_coulomb` material; of an interface its tangent is the `mu` of the contact's `friction`",
    ),
    (&["dilatancyangle", "dilationangle"], &["psi"], "of a `mohr_coulomb` material"),
    (
        &["type", "materialmodel", "constitutivemodel", "constitutivelaw"],
        &["model", "law"],
        "of a body's `material`, and `law` of a contact's `friction`",
    ),
    (
        &["frictioncoefficient", "coefficientoffriction", "frictioncoeff", "cof"],
        &["mu"],
        "of a contact's `friction`, with \"law\": \"coulomb\"",
    ),
    (&["staticfriction", "mustatic"], &["mu_s"], "of a contact's `friction`"),
    (&["dynamicfriction", "kineticfriction", "mudynamic", "mukinetic"], &["mu_k", "mu_d"], "of a contact's `friction`"),
    (&["secondary", "secondarysurface", "slavesurface", "source"], &["slave"], "of a contact"),
    (&["primary", "primarysurface", "main", "mainsurface", "mastersurface", "target"], &["master"], "of a contact"),
    (
        &["interference", "interferencefit", "overclosure", "initialgap", "gap", "pressfit"],
        &["clearance"],
        "of a contact: positive for a gap, negative for an interference",
    ),
    (&["penalty", "penaltystiffness", "normalstiffness", "kn"], &["alpha_n"], "of a contact's `normal`"),
    (&["shearstiffness", "tangentialstiffness", "ks", "kt"], &["alpha_t"], "of a contact's `friction`"),
    (&["interactions", "interaction", "interfaces", "contactpairs"], &["contacts"], "of a case"),
    (&["parts", "instances", "solids", "regions", "clusters"], &["bodies"], "of a case"),
    (
        &["boundary", "boundaries", "boundaryconditions", "bcs", "bc", "constraints", "dirichlet", "fixities"],
        &["supports"],
        "of a step",
    ),
    (&["neumann", "forces", "tractions", "dload", "cload", "surcharge", "surcharges"], &["loads"], "of a step"),
    (&["stages", "phases", "loadsteps", "stage", "phase"], &["steps"], "of a case"),
    (&["timestep", "timeincrement", "increment", "increments", "deltat", "timestepping"], &["dt"], "of a step"),
    (&["endtime", "totaltime", "timeperiod", "tend"], &["duration"], "of a step"),
    (&["procedure", "analysis", "analysistype", "steptype"], &["scheme"], "of a step"),
    (&["nset", "nodeset", "elset", "set", "region"], &["on"], "of a support or load: the name of a group"),
    (&["monitor", "historyoutput", "outputrequests", "sensors"], &["watch"], "of a case"),
    (&["apart"], &["separated"], "of a mesh of blocks"),
    (&["initialconditions"], &["initial_stress", "initial"], "of a body, and `initial` of a contact"),
];

/// What another program's word is here, as a sentence for an object with these keys.
pub fn here(word: &str, known: &[&str]) -> Option<String> {
    let plain: String = word.to_lowercase().chars().filter(|c| !matches!(c, '_' | '-' | ' ' | '\'')).collect();
    let (_, keys, place) = WORDS.iter().find(|(words, ..)| words.contains(&plain.as_str()))?;
    Some(match keys.iter().find(|key| known.contains(key)) {
        Some(key) => format!("here that is `{key}`"),
        None => format!("that is `{}` {place}", keys[0]),
    })
}
