use super::print_json;
use crate::args::ValidateArgs;
use crate::ui::Outcome;
use serde::Serialize;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;
use tousle_eff::Validation;
use tousle_pipeline::Watch;

/// What is said of one file.
#[derive(Serialize)]
struct Verdict {
    file: String,
    /// Set when the file cannot be read at all.
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<String>,
    #[serde(flatten)]
    validation: Option<Validation>,
}

impl Verdict {
    fn is_sound(&self) -> bool {
        self.validation.as_ref().is_some_and(|v| v.is_sound)
    }
}

/// `tousle validate`
pub fn run(args: &ValidateArgs, watch: &dyn Watch) -> anyhow::Result<Outcome> {
    let stage = watch.stage("validate");
    let mut verdicts = Vec::with_capacity(args.files.len());
    for (k, file) in args.files.iter().enumerate() {
        verdicts.push(validate(file));
        stage.at(k as u64 + 1, args.files.len() as u64);
    }
    drop(stage);
    if args.json {
        print_json(&verdicts)?;
    } else {
        verdicts.iter().for_each(print);
    }
    Ok(if verdicts.iter().all(Verdict::is_sound) { Outcome::Fine } else { Outcome::Invalid })
}

fn validate(path: &Path) -> Verdict {
    let file = path.display().to_string();
    let validation =
        File::open(path).map_err(Into::into).and_then(|f| tousle_eff::validate(BufReader::new(f)));
    match validation {
        Ok(validation) => Verdict { file, error: None, validation: Some(validation) },
        Err(error) => {
            Verdict { file, error: Some(format!("{:#}", anyhow::Error::from(error))), validation: None }
        }
    }
}

fn print(verdict: &Verdict) {
    if let Some(error) = &verdict.error {
        println!("{}: {error}", verdict.file);
    }
    let Some(validation) = &verdict.validation else { return };
    let (n, sound) = (validation.findings.len(), if validation.is_sound { "sound" } else { "NOT SOUND" });
    println!("{}: {sound}{}", verdict.file, if n == 0 { String::new() } else { format!(", {n} findings") });
    for finding in &validation.findings {
        println!("  {finding}");
    }
    if validation.n_more > 0 {
        println!("  … and {} more", validation.n_more);
    }
}
